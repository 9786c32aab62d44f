// SPDX-License-Identifier: Apache-2.0
// What the C++ libraries leave to the platform, and WASI does not have.

/// Registers a destructor of a thread's object. A module has one thread, which never ends.
extern "C" int __cxa_thread_atexit(void (*)(void*), void*, void*) { return 0; }
