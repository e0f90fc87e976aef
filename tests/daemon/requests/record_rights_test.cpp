// SPDX-License-Identifier: Apache-2.0
//
// Whom the real daemon lets make files, and which.
#include <filesystem>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

using ::testing::HasSubstr;

class RecordRightsTest : public DaemonTest {
protected:
    /// The refusal; empty: it records.
    static std::string start_recording(const std::string& address, const std::string& path) {
        WireClient client(address);
        client.hello();
        v1::Envelope request;
        request.mutable_record_start()->set_path(path);
        client.send(request);
        const auto answer = client.receive();
        return answer ? answer->envelope.error().message() : "no answer";
    }

    std::string without_folder() const {
        std::string text = config_text();
        const auto key = text.find("directory = ");
        return text.replace(key, text.find('\n', key) - key, "");
    }
};

TEST_F(RecordRightsTest, WithoutAFolderOnlyTheDaemonsUserRecords) {
    const auto daemon = start_ready(without_folder(), {"--set", "socket.tcp_control=true"});
    EXPECT_THAT(start_recording(daemon->address("tcp:"), "a.mkv"), HasSubstr("[record] directory"));
    EXPECT_FALSE(std::filesystem::exists(folder_.path() + "/a.mkv"));
    EXPECT_EQ(start_recording(daemon->address("unix:"), "a.mkv"), "");
    EXPECT_TRUE(std::filesystem::exists(folder_.path() + "/a.mkv"));
}

TEST_F(RecordRightsTest, OverTcpOnlyWhereThatIsConfigured) {
    const auto daemon = start_ready(config_text());
    EXPECT_THAT(start_recording(daemon->address("tcp:"), "a.mkv"), HasSubstr("[socket] tcp_control"));
    EXPECT_FALSE(std::filesystem::exists(folder_.path() + "/a.mkv"));
}

TEST_F(RecordRightsTest, OthersMayNotReadARecording) {
    const auto daemon = start_ready(config_text());
    const mode_t mask = umask(0);
    umask(mask);
    EXPECT_EQ(start_recording(daemon->address("unix:"), "a.mkv"), "");
    struct stat found {};
    ASSERT_EQ(stat((folder_.path() + "/a.mkv").c_str(), &found), 0);
    EXPECT_EQ(found.st_mode & 0777, 0640U & ~mask);
}

}  // namespace
}  // namespace disparityd::test
