// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/abuse_fixture.h"

namespace disparityd::test {
namespace {

TEST_F(AbuseTest, GoodClientsMissNothing) {
    run(config_text(), std::chrono::seconds(6));
}

}  // namespace
}  // namespace disparityd::test
