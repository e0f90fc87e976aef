// SPDX-License-Identifier: Apache-2.0
#include "base/access/tokens.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tests/temporary_folder.h"

namespace disparityd::base {
namespace {

using test::TemporaryFolder;
using ::testing::HasSubstr;

class TokenFileTest : public ::testing::Test {
protected:
    std::string written(const std::string& text, mode_t mode = 0600) {
        const std::string path = folder_.write("tokens", text);
        chmod(path.c_str(), mode);
        return path;
    }

    std::string error_of(const std::string& path) {
        try {
            read_tokens(path);
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return "";
    }

    TemporaryFolder folder_;
};

TEST_F(TokenFileTest, EachLineIsARightAndAToken) {
    const Tokens tokens = read_tokens(
        written("# of the robot\nview 0123456789abcdef\n\ncontrol fedcba9876543210\nview another-token-of-mine\n"));
    EXPECT_THAT(tokens.viewers(), testing::ElementsAre("0123456789abcdef", "another-token-of-mine"));
    EXPECT_THAT(tokens.controllers(), testing::ElementsAre("fedcba9876543210"));
    EXPECT_EQ(tokens.right_of("another-token-of-mine"), Right::view);
    EXPECT_EQ(tokens.right_of("fedcba9876543210"), Right::control);
    for (const char* wrong : {"", "fedcba987654321", "fedcba98765432100", "Fedcba9876543210"}) {
        EXPECT_EQ(tokens.right_of(wrong), Right::none) << wrong;
    }
}

TEST_F(TokenFileTest, AWrongLineIsNamed) {
    for (const char* line : {"view short", "look 0123456789abcdef", "view", "view 0123456789 abcdef",
                             "0123456789abcdef", "view\t0123456789abcdef"}) {
        EXPECT_THAT(error_of(written(std::string("# one\n") + line + "\n")), HasSubstr("tokens:2: allowed: ")) << line;
    }
    EXPECT_THAT(error_of(written("# nobody\n")), HasSubstr("holds no token"));
    EXPECT_THAT(error_of(folder_.path() + "/none"), HasSubstr("cannot be read"));
    EXPECT_THAT(error_of(folder_.path()), HasSubstr("cannot be read"));
}

TEST_F(TokenFileTest, APipeIsNotWaitedFor) {
    const std::string pipe = folder_.file("pipe");
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_THAT(error_of(pipe), HasSubstr("the tokens is not a regular file"));
    EXPECT_THAT(error_of("/dev/null"), HasSubstr("not a regular file"));
}

TEST_F(TokenFileTest, AFileThatOthersMayReadIsRefused) {
    EXPECT_THAT(error_of(written("view 0123456789abcdef\n", 0644)), HasSubstr("chmod o-rw"));
}

}  // namespace
}  // namespace disparityd::base
