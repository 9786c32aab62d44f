# SPDX-License-Identifier: Apache-2.0
# Builds for browsers: WebAssembly with SIMD128, by clang 19 with the C++ library for WASI of the packages lld-19,
# libc++-19-dev-wasm32, libclang-rt-19-dev-wasm32 and wasi-libc.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(CMAKE_CXX_COMPILER clang++-19)
set(CMAKE_CXX_COMPILER_TARGET wasm32-wasi)
set(CMAKE_EXECUTABLE_SUFFIX_CXX .wasm)
set(KERF_WASM ON)
# No relaxed SIMD: its results differ between machines.
add_compile_options(-msimd128 -fno-exceptions)
add_link_options(-Wl,-z,stack-size=4194304)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
