#!/usr/bin/env bash
# The tests of the same bits, built for other processors and run by qemu's emulators of them.
# processors.sh [PROCESSOR...]: those named, or all.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
processors=("$@")
[[ ${#processors[@]} -gt 0 ]] || processors=(aarch64 riscv64 i686)

# As Debian and Ubuntu call what they need.
declare -A rust=([aarch64]=aarch64 [riscv64]=riscv64gc [i686]=i686)
declare -A debian=([aarch64]=arm64 [riscv64]=riscv64 [i686]=i386) qemu=([i686]=i386)

for processor in "${processors[@]}"; do
  target=${rust[$processor]}-unknown-linux-gnu
  linker=$processor-linux-gnu-gcc emulator=qemu-${qemu[$processor]:-$processor}
  tests/need.sh "$linker $emulator" \
    "gcc-$processor-linux-gnu libc6-dev-${debian[$processor]}-cross qemu-user"
  rustup target add "$target" || rustc --print target-libdir --target "$target"
  setting=CARGO_TARGET_$(tr a-z- A-Z_ <<< "$target")
  export "${setting}_LINKER=$linker" "${setting}_RUNNER=$emulator -L /usr/$processor-linux-gnu"
  # Each needs what it is compiled for, so that a build for this machine stays where it is.
  cargo test --locked --target "$target" --test physics --test environment -- same_bits determinism
  echo "The same bits on $processor."
done
