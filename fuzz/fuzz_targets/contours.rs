#![no_main]

#[path = "../targets/mod.rs"]
mod readers;

libfuzzer_sys::fuzz_target!(|data: &[u8]| readers::contours::check(data));
