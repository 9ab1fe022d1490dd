//! The `furrow` command.

fn main() -> std::process::ExitCode {
    furrow::cli::main()
}
