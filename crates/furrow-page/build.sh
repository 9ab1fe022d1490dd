#!/bin/sh
# Builds what runs inside the report, crates/furrow-report/src/page/furrow.wasm.txt, from the sources as they are. Runs from any folder.
#
# The file has two lines: the version of the solver, and the module, compressed and in base64.
# `tests/project/page_artefact.rs` refuses a module with another solver; this is then the one command to run.
#
#   crates/furrow-page/build.sh [FILE]     writes FILE in place of crates/furrow-report/src/page/furrow.wasm.txt
set -eu
cd "$(dirname "$0")/../.."
out=${1:-crates/furrow-report/src/page/furrow.wasm.txt}
target=wasm32-unknown-unknown

rustup target list --installed | grep -qx "$target" || rustup target add "$target"

# Paths of this machine have no place in a file that is kept.
flags="-C target-feature=+simd128 --remap-path-prefix=$PWD=furrow"
for folder in "${CARGO_HOME:-$HOME/.cargo}"/registry/src/*; do
    flags="$flags --remap-path-prefix=$folder=crates"
done
RUSTFLAGS="$flags" cargo build --locked --quiet --package furrow-page --lib --profile page --target "$target"

built=${CARGO_TARGET_DIR:-target}/$target/page
solver=$(sed -n 's/^pub const SOLVER_VERSION: u32 = \([0-9]*\);$/\1/p' crates/furrow-lineage/src/batch/key.rs)
{
    echo "solver ${solver:?not found}"
    gzip -9 --no-name --stdout "$built/page.wasm" | base64 | tr -d '\n'
    echo
} >"$out.new"
mv "$out.new" "$out"
echo "$out: $(wc -c <"$built/page.wasm") bytes, $(wc -c <"$out") as kept; solver $solver"
