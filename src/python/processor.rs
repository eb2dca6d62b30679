//! What the processor must be able to do: builds that `make` makes use AVX2 where the machine that compiles has it.

use pyo3::prelude::*;

/// Whether this build needs AVX2.
pub(crate) const USES_AVX2: bool = cfg!(target_feature = "avx2");

/// Refuses a processor that lacks what this build uses, before the first such instruction kills the process.
pub(crate) fn check() -> PyResult<()> {
    #[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
    {
        const LEAF: u32 = 7;
        const AVX2: u32 = 1 << 5;
        let registers = core::arch::x86_64::__cpuid_count(LEAF, 0);
        if registers.ebx & AVX2 == 0 {
            return Err(pyo3::exceptions::PyImportError::new_err(
                "this build of flockenv is for processors with AVX2: build it here (`make build`), or install a wheel",
            ));
        }
    }
    Ok(())
}
