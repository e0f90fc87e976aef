// SPDX-License-Identifier: Apache-2.0
//
// Linked into a test program: whatever its tests did, the kernel must not have complained.
#include <algorithm>
#include <cstdio>
#include <fstream>

#include <gmock/gmock.h>

#include "tests/vm/guest/kernel_log.h"

namespace vm_guest {
namespace {

class NoKernelComplaints : public testing::Environment {
public:
    void TearDown() override {
        const auto complaints = kernel_complaints();
        EXPECT_THAT(complaints, testing::IsEmpty());
        if (!complaints.empty()) {
            const auto log = kernel_log();
            const std::size_t shown = std::min<std::size_t>(log.size(), 100);
            for (auto line = log.end() - static_cast<std::ptrdiff_t>(shown); line != log.end(); ++line) {
                std::printf("%s\n", line->c_str());
            }
        }
        // That a complaint would have been seen.
        std::ofstream("/dev/kmsg") << "a test writes WARNING: CPU" << std::endl;
        EXPECT_THAT(kernel_complaints(), testing::SizeIs(complaints.size() + 1));
    }
};

const auto* const environment = testing::AddGlobalTestEnvironment(new NoKernelComplaints);

}  // namespace
}  // namespace vm_guest
