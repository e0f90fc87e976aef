// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {

/// Every kind of broken client at once against the real daemon, while good clients must miss no frame.
class AbuseTest : public DaemonTest {
protected:
    void run(const std::string& config, std::chrono::seconds duration);

private:
    std::unique_ptr<DaemonProcess> abuser(const std::string& manner, const std::string& address);
};

}  // namespace disparityd::test
