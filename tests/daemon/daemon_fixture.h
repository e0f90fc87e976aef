// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include "proto/disparity.pb.h"
#include "tests/daemon/daemon_process.h"
#include "tests/daemon/wire_client.h"

namespace disparityd::test {

/// Real daemons on the rendered scene, matched at a small size; each test has its own names and ports.
class DaemonTest : public ::testing::Test {
protected:
    /// Daemons that still ran were killed and have left it behind.
    ~DaemonTest() override { ::shm_unlink(("/disparityd." + shared_memory_name()).c_str()); }

    static constexpr const char* scene = "scene:vga@15?width=320&height=176&loop=8";

    std::string shared_memory_name() const { return "test-" + std::to_string(getpid()); }

    /// The configuration file of these tests; `more` is put behind it.
    std::string config_text(const std::string& uri = scene, int width = 160, int height = 88,
                            const std::string& more = "") const {
        return "[source]\nuri = \"" + uri + "\"\n[rectify]\nwidth = " + std::to_string(width) +
               "\nheight = " + std::to_string(height) +
               "\n[match]\nmethod = \"census\"\ndisparities = 32\n[pipeline]\nworkers = 1\n[shared_memory]\nname = \"" +
               shared_memory_name() + "\"\n[socket]\ntcp = \"127.0.0.1:0\"\nunix = \"" + folder_.path() +
               "/d.sock\"\n[record]\ndirectory = \"" + folder_.path() + "\"\n" + more;
    }

    /// A daemon with that file as its configuration; the caller waits for what it expects.
    std::unique_ptr<DaemonProcess> start(const std::string& config, std::vector<std::string> more = {},
                                         const DaemonProcess::Environment& environment = {}) {
        std::vector<std::string> arguments{"--print-address", "--config", folder_.write("d.toml", config)};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return std::make_unique<DaemonProcess>(folder_, arguments, environment);
    }

    std::unique_ptr<DaemonProcess> start_ready(const std::string& config, std::vector<std::string> more = {}) {
        auto daemon = start(config, std::move(more));
        EXPECT_TRUE(daemon->wait_until_ready()) << daemon->log();
        return daemon;
    }

    static WireClient subscriber(const std::string& address, const std::vector<v1::Product>& products,
                                 const std::string& name = "test") {
        WireClient client(address);
        const auto welcome = client.hello(name);
        EXPECT_TRUE(welcome && welcome->has_welcome());
        EXPECT_TRUE(client.send(subscription(products)));
        return client;
    }

    TemporaryFolder folder_;
};

}  // namespace disparityd::test
