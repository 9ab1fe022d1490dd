//! The fuzzer of the target that it is named after.
#![no_main]

#[path = "targets/mod.rs"]
mod readers;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let (_, check) = readers::TARGETS.iter().find(|(name, _)| *name == env!("CARGO_BIN_NAME")).expect("a target");
    check(data);
});
