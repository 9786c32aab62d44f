// SPDX-License-Identifier: Apache-2.0
// What the C++ libraries leave to the platform, and WASI does not have.

#include <vector>  // declares std::__libcpp_verbose_abort

/// Registers a destructor of a thread's object. A module has one thread, which never ends.
extern "C" int __cxa_thread_atexit(void (*)(void*), void*, void*) { return 0; }

/// What the libraries print before they abort would pull in all of printf.
void std::__libcpp_verbose_abort(const char*, ...) { __builtin_trap(); }
extern "C" void abort_message(const char*, ...) { __builtin_trap(); }
