// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/abuse_fixture.h"

namespace disparityd::test {
namespace {

// The whole image, so that those who do not read fill the system's buffers.
/// Takes longer than the tests that everybody runs.
using SlowAbuseTest = AbuseTest;

TEST_F(SlowAbuseTest, GoodClientsMissNothingForAMinute) {
    run(config_text("scene:vga@15", 0, 0), std::chrono::seconds(60));
}

}  // namespace
}  // namespace disparityd::test
