// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "kernels/matcher.h"
#include "tests/emulation/thoroughness.h"

namespace disparityd::test {

/// Skips where the back end cuda has no device.
class CudaDevice : public testing::Test {
protected:
    void SetUp() override {
        const std::string why = backends().front().unavailable_because();
        if (!why.empty()) {
            GTEST_SKIP() << why;
        }
    }
};

/// While it lives, the emulated device runs in its n-th way: threads and blocks in another order, more or fewer blocks
/// at a time, memory that nobody has written with another value. A real device has ways of its own, and nothing
/// happens.
class Variation {
public:
    explicit Variation(int n);
    ~Variation();
    Variation(const Variation&) = delete;
    Variation& operator=(const Variation&) = delete;
};

}  // namespace disparityd::test
