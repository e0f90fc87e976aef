// SPDX-License-Identifier: Apache-2.0
//
// Linked into a test program: whatever its tests did, the kernel must not have complained.
#include <fstream>

#include <gmock/gmock.h>

#include "tests/vm/guest/kernel_log.h"

namespace vm_guest {
namespace {

class NoKernelComplaints : public testing::Environment {
public:
    void TearDown() override {
        EXPECT_THAT(kernel_complaints(), testing::IsEmpty());
        // That a complaint would have been seen.
        std::ofstream("/dev/kmsg") << "a test writes WARNING: CPU" << std::endl;
        EXPECT_THAT(kernel_complaints(), testing::SizeIs(1));
    }
};

const auto* const environment = testing::AddGlobalTestEnvironment(new NoKernelComplaints);

}  // namespace
}  // namespace vm_guest
