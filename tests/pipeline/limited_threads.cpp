// SPDX-License-Identifier: Apache-2.0
#include "tests/pipeline/limited_threads.h"

#include <atomic>
#include <cerrno>

#include <dlfcn.h>
#include <pthread.h>

namespace {

std::atomic<int> allowed{-1};

}  // namespace

namespace disparityd::test {

void allow_threads(int count) {
    allowed = count;
}

}  // namespace disparityd::test

// In the place of the C library's, which it calls.
extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*start)(void*),
                              void* argument) {
    using Create = int(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
    static auto* const create = reinterpret_cast<Create*>(dlsym(RTLD_NEXT, "pthread_create"));
    if (allowed == 0) {
        return EAGAIN;
    }
    if (allowed > 0) {
        --allowed;
    }
    return create(thread, attributes, start, argument);
}
