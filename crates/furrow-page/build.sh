#!/bin/sh
# Builds the module that runs inside the page and writes it to crates/furrow-report/src/page/furrow.wasm.txt. Runs from any
# folder.
#
# The file has two lines: the version of the solver, and the module, compressed and in base64.
# `tests/project/page_artefact.rs` fails if the version is another one; then run this script.
#
#   crates/furrow-page/build.sh [FILE]     writes FILE instead
set -eu
cd "$(dirname "$0")/../.."
out=${1:-crates/furrow-report/src/page/furrow.wasm.txt}
target=wasm32-unknown-unknown

rustup target list --installed | grep -qx "$target" || rustup target add "$target"

# The file must not depend on the paths of this machine.
flags="-C target-feature=+simd128 --remap-path-prefix=$PWD=furrow"
for folder in "${CARGO_HOME:-$HOME/.cargo}"/registry/src/*; do
    flags="$flags --remap-path-prefix=$folder=crates"
done
RUSTFLAGS="$flags" cargo build --locked --quiet --package furrow-page --lib --profile page --target "$target"

built=${CARGO_TARGET_DIR:-target}/$target/page/furrow_page.wasm
if grep -aq __wbindgen "$built"; then
    echo "the module needs wasm-bindgen, which the page does not have: see cargo tree --target $target -i wasm-bindgen" >&2
    exit 1
fi
solver=$(sed -n 's/^pub const SOLVER_VERSION: u32 = \([0-9]*\);$/\1/p' crates/furrow-lineage/src/batch/key.rs)
{
    echo "solver ${solver:?not found}"
    gzip -9 --no-name --stdout "$built" | base64 | tr -d '\n'
    echo
} >"$out.new"
mv "$out.new" "$out"
echo "$out: $(wc -c <"$built") bytes, $(wc -c <"$out") as kept; solver $solver"
