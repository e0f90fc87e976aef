// SPDX-License-Identifier: Apache-2.0
//
// Which daemon disparityctl believes, and what it prints of that daemon's words.
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "proto/framing.h"
#include "tests/proto/fake_daemon.h"
#include "tests/temporary_folder.h"
#include "tests/tools/run_program.h"
#include "tools/command_line/printable_output.h"
#include "tools/command_line/table.h"
#include "tools/ctl/daemon.h"

namespace disparityd::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr uid_t nobody = 65534;

/// A socket in the folder XDG_RUNTIME_DIR, where a daemon of the name "mine" would listen.
class SocketOfADaemon : public testing::Test {
protected:
    SocketOfADaemon() {
        setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1);
        fd_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
        sockaddr_un name{};
        name.sun_family = AF_UNIX;
        path_.copy(name.sun_path, sizeof name.sun_path - 1);
        EXPECT_EQ(bind(fd_, reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
    }
    ~SocketOfADaemon() override {
        ::close(fd_);
        unsetenv("XDG_RUNTIME_DIR");
    }

    /// Takes one connection, and greets it as a daemon does.
    void greet_one() const {
        const int connection = accept(fd_, nullptr, nullptr);
        ServerEnd(connection).greet();
        char none = 0;
        EXPECT_EQ(recv(connection, &none, 1, 0), 0) << "the client goes";
        ::close(connection);
    }

    static bool is_root() { return geteuid() == 0; }

    tools::DaemonArguments mine_{"mine", {}, {}};
    TemporaryFolder folder_;
    std::string path_ = folder_.file("disparityd-mine.sock");
    int fd_ = -1;
};

TEST_F(SocketOfADaemon, OfAnotherUserIsLeftAlone) {
    if (!is_root() || chown(path_.c_str(), nobody, nobody) != 0) {
        GTEST_SKIP() << "only root gives files to others";
    }
    EXPECT_THAT([&] { tools::connect(mine_); }, testing::ThrowsMessage<std::runtime_error>(AllOf(
                                                    HasSubstr("no daemon answers"), HasSubstr("belongs to user 65534"),
                                                    HasSubstr("if that daemon is meant, say unix:" + path_))));
    ASSERT_EQ(listen(fd_, 4), 0);
    std::thread daemon([this] { greet_one(); });
    { EXPECT_EQ(tools::connect({"mine", path_, {}}).where(), "unix:" + path_) << "who names it means it"; }
    daemon.join();
}

TEST_F(SocketOfADaemon, BehindALinkIsLeftAlone) {
    ASSERT_EQ(listen(fd_, 4), 0);
    std::filesystem::create_symlink(path_, folder_.file("disparityd-linked.sock"));
    EXPECT_THAT(
        [&] {
            tools::connect({"linked", {}, {}});
        },
        testing::ThrowsMessage<std::runtime_error>(HasSubstr("there is no Unix socket of a daemon named linked")));
}

TEST_F(SocketOfADaemon, WithAProcessOfAnotherUserBehindItIsLeftAlone) {
    if (!is_root() || seteuid(nobody) != 0) {
        GTEST_SKIP() << "only root can be somebody else";
    }
    const int listening = listen(fd_, 4);  // the system remembers whose this was
    ASSERT_EQ(seteuid(0), 0);
    ASSERT_EQ(listening, 0);
    std::thread daemon([this] { greet_one(); });
    EXPECT_THAT([&] { tools::connect(mine_); },
                testing::ThrowsMessage<std::runtime_error>(HasSubstr("its process belongs to user 65534")));
    daemon.join();
}

TEST_F(SocketOfADaemon, OfThisUserWithItsOwnProcessIsConnectedTo) {
    ASSERT_EQ(listen(fd_, 4), 0);
    std::thread daemon([this] { greet_one(); });
    { EXPECT_EQ(tools::connect(mine_).socket().server_user(), geteuid()); }
    daemon.join();
}

TEST_F(SocketOfADaemon, OfAnotherNameIsNamedWhereNoneAnswers) {
    const auto said = [] {
        try {
            tools::connect({"absent", {}, {}});
        } catch (const std::runtime_error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_THAT(said(), Not(HasSubstr("mine"))) << "nobody listens there";
    ASSERT_EQ(listen(fd_, 4), 0);
    EXPECT_THAT(said(), AllOf(HasSubstr("no daemon answers"), HasSubstr("daemons of other names run: "),
                              HasSubstr("mine"), HasSubstr("say which one")));
}

TEST_F(SocketOfADaemon, CannotHaveANameThatIsAPath) {
    for (const std::string name : {"../x", "", "a b"}) {
        EXPECT_THAT(
            [&] {
                tools::connect({name, {}, {}});
            },
            testing::ThrowsMessage<std::invalid_argument>(
                AllOf(HasSubstr("--name: found '" + name + "'"), HasSubstr("allowed: 1 to 64"))));
    }
}

const std::string hostile =
    "x\x1b[2J\r\nstate       forged\x7f\xc2\x9b"
    "5A\xc3\xa9";

TEST(DaemonsWords, AreOneLineWithoutControls) {
    v1::Envelope answer;
    v1::Status& status = *answer.mutable_status();
    status.set_state(hostile);
    status.set_detail(hostile);
    status.set_source(hostile);
    status.mutable_camera()->set_state(hostile);
    status.mutable_record()->set_path(hostile);
    status.add_notices(hostile);
    status.add_steps()->set_name(hostile);
    status.add_clients()->set_name(hostile);
    FakeDaemon daemon([&answer](ServerEnd& end) {
        end.greet();
        v1::Envelope request;
        if (end.receive(request)) {
            end.send(answer);
        }
    });
    const Outcome outcome = run(DISPARITYCTL, {"status", "--socket", daemon.unix_address()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, Not(testing::ContainsRegex("[\x01-\x09\x0b-\x1f\x7f]")));
    EXPECT_THAT(outcome.out, AllOf(Not(HasSubstr("\xc2\x9b")), Not(HasSubstr("\nstate       forged"))));
    EXPECT_THAT(outcome.out, HasSubstr("notice      x?[2J??state       forged???5A\xc3\xa9\n"));
    EXPECT_THAT(outcome.out, HasSubstr("\nx?[2J??state       forged???5A\xc3\xa9  ")) << "a client's row";
}

TEST(DaemonsWords, AreOneLineInErrors) {
    FakeDaemon daemon([](ServerEnd& end) {
        v1::Envelope hello;
        end.receive(hello);
        v1::Envelope answer;
        answer.mutable_error()->set_message(hostile);
        end.send(answer);
    });
    try {
        disparity::SocketClient(daemon.unix_address());
        FAIL() << "the refusal was not told";
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), testing::EndsWith(": x?[2J??state       forged??5A\xc3\xa9"));
    }
}

TEST(PrintableOutput, LetsLinesAndLettersThrough) {
    std::ostringstream stream;
    {
        const tools::PrintableOutput printable(stream);
        stream << "a\tb\n\x1b[1m caf\xc3\xa9 \xc2\xb5m \xc2\x9b" << '\xc2' << '\x85' << '\xc2' << '\xa0' << '\x7f' << 1;
        stream << "\xc2" << std::flush << "z\r" << '\xc2';
    }
    EXPECT_EQ(stream.str(), "a\tb\n?[1m caf\xc3\xa9 \xc2\xb5m ????\xc2\xa0?1\xc2z?\xc2");
    stream << "\x1b";
    EXPECT_EQ(stream.str().back(), '\x1b') << "as before, at its end";
}

TEST(TableCells, AreOneLine) {
    std::ostringstream stream;
    tools::Table table({"name", "n"});
    table.add({"a\nb\x1b", "1"});
    table.print(stream);
    EXPECT_EQ(stream.str(), "name  n\na?b?  1\n");
}

}  // namespace
}  // namespace disparityd::test
