// SPDX-License-Identifier: Apache-2.0
//
// The certificates that disparityctl makes, as the program openssl judges them, and a daemon and clients that use them.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/daemon/daemon_process.h"
#include "tests/proto/command_output.h"
#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"

namespace disparityd::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class CertificatesTest : public FolderTest {
protected:
    Outcome make(std::vector<std::string> more) const {
        more.insert(more.begin(), {"certificates", path("tls")});
        return run(DISPARITYCTL, more);
    }

    void expect_refused(const std::vector<std::string>& more, const testing::Matcher<std::string>& says) const {
        const Outcome outcome = make(more);
        EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
        EXPECT_THAT(outcome.err, says);
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    }

    std::vector<std::string> files() const {
        std::vector<std::string> names;
        if (std::filesystem::exists(path("tls"))) {
            for (const auto& entry : std::filesystem::directory_iterator(path("tls"))) {
                names.push_back(entry.path().filename().string());
            }
        }
        std::sort(names.begin(), names.end());
        return names;
    }

    mode_t mode(const std::string& name) const {
        struct stat facts {};
        EXPECT_EQ(stat(path("tls/" + name).c_str(), &facts), 0) << name;
        return facts.st_mode & 07777U;
    }

    /// What `openssl verify` says of a certificate.
    std::string verdict(const std::string& options, const std::string& name) const {
        return command_output("openssl verify -x509_strict -CAfile " + path("tls/authority.crt") + ' ' + options + ' ' +
                              path("tls/" + name) + " 2>&1")
            .second;
    }
};

TEST_F(CertificatesTest, OpensslTakesThem) {
    if (command_output("openssl version").first != 0) {
        GTEST_SKIP() << "the program openssl is not installed";
    }
    const Outcome made = make({"--host", "robot.example", "--host", "192.168.1.5", "--client", "pilot"});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    EXPECT_THAT(verdict("-purpose sslserver -verify_hostname robot.example", "server.crt"), HasSubstr("OK"));
    EXPECT_THAT(verdict("-purpose sslserver -verify_ip 192.168.1.5", "server.crt"), HasSubstr("OK"));
    EXPECT_THAT(verdict("-purpose sslclient", "pilot.crt"), HasSubstr("OK"));
    EXPECT_THAT(verdict("-verify_hostname localhost", "server.crt"), HasSubstr("hostname mismatch")) << "not asked for";
    EXPECT_THAT(verdict("-purpose sslserver", "pilot.crt"), HasSubstr("purpose"));
    EXPECT_THAT(verdict("-purpose sslclient", "server.crt"), HasSubstr("purpose"));
    EXPECT_THAT(command_output("openssl x509 -noout -subject -nameopt RFC2253 -in " + path("tls/pilot.crt")).second,
                HasSubstr("CN=pilot"));
    // Of another folder, all but for the key the same.
    const Outcome other = run(DISPARITYCTL, {"certificates", path("other"), "--client", "pilot"});
    ASSERT_EQ(other.exit_code, 0) << other.err;
    EXPECT_THAT(
        command_output("openssl verify -CAfile " + path("tls/authority.crt") + ' ' + path("other/pilot.crt") + " 2>&1")
            .second,
        testing::Not(HasSubstr("OK")));
}

TEST_F(CertificatesTest, KeysAreForTheirOwnerOnly) {
    const mode_t before = umask(0);
    const Outcome made = make({"--client", "a"});
    umask(before);
    ASSERT_EQ(made.exit_code, 0) << made.err;
    EXPECT_THAT(files(),
                testing::ElementsAre("a.crt", "a.key", "authority.crt", "authority.key", "server.crt", "server.key"));
    for (const char* key : {"a.key", "authority.key", "server.key"}) {
        EXPECT_EQ(mode(key), 0600U) << key;
    }
    EXPECT_EQ(mode("a.crt"), 0644U);
    EXPECT_THAT(made.out,
                AllOf(HasSubstr("client_authority"), HasSubstr("--socket tls:HOST:9876"), HasSubstr("localhost")));
}

TEST_F(CertificatesTest, NothingIsReplaced) {
    ASSERT_EQ(make({"--client", "a"}).exit_code, 0);
    const auto text = [&](const char* name) {
        return command_output("cat " + path(std::string("tls/") + name)).second;
    };
    const std::string server = text("server.crt");
    const std::string authority = text("authority.crt");
    expect_refused({"--client", "a"}, AllOf(HasSubstr("a.crt"), HasSubstr("exists already")));
    expect_refused({"--client", "b", "--client", "a"}, HasSubstr("a.crt"));
    expect_refused({"--host", "robot"}, HasSubstr("server.crt"));
    expect_refused({}, HasSubstr("--client NAME"));
    EXPECT_EQ(files().size(), 6U) << "nothing is made of an order that is refused";
    ASSERT_EQ(make({"--client", "b"}).exit_code, 0);
    EXPECT_EQ(text("server.crt"), server);
    EXPECT_EQ(text("authority.crt"), authority);
    // One half of a pair is somebody's file, too.
    std::filesystem::remove(path("tls/authority.crt"));
    expect_refused({"--client", "c"}, HasSubstr("authority.key"));
}

TEST_F(CertificatesTest, RevokedOnesAreOnAListThatOpensslReads) {
    if (command_output("openssl version").first != 0) {
        GTEST_SKIP() << "the program openssl is not installed";
    }
    ASSERT_EQ(make({"--client", "a", "--client", "b", "--client", "c"}).exit_code, 0);
    const Outcome first = make({"--revoke", "a"});
    ASSERT_EQ(first.exit_code, 0) << first.err;
    EXPECT_THAT(first.out, AllOf(HasSubstr("a on it now"), HasSubstr("reload")));
    const auto expect_revoked = [&](const std::string& name, bool revoked) {
        const std::string says = verdict("-crl_check -purpose sslclient", name + ".crt");
        EXPECT_THAT(says, HasSubstr(revoked ? "certificate revoked" : "OK")) << name;
    };
    expect_revoked("a", true);
    expect_revoked("b", false);
    ASSERT_EQ(make({"--revoke", "b", "--revoke", "c"}).exit_code, 0);
    for (const char* name : {"a", "b", "c"}) {
        expect_revoked(name, true);
    }
    EXPECT_THAT(verdict("-crl_check -purpose sslserver", "server.crt"), HasSubstr("OK"));
    EXPECT_THAT(command_output("openssl crl -noout -crlnumber -in " + path("tls/authority.crt")).second,
                testing::EndsWith("2\n"));
    ASSERT_EQ(make({"--client", "d"}).exit_code, 0) << "the authority with its list is used again";
    expect_revoked("d", false);
    EXPECT_EQ(mode("authority.crt"), 0644U);
    EXPECT_EQ(files().size(), 12U) << "nothing else is left";
}

TEST_F(CertificatesTest, WhatCannotBeRevokedChangesNothing) {
    ASSERT_EQ(make({"--client", "a"}).exit_code, 0);
    ASSERT_EQ(make({"--revoke", "a"}).exit_code, 0);
    const std::string before = command_output("cat " + path("tls/authority.crt")).second;
    expect_refused({"--revoke", "a"}, HasSubstr("of a is revoked already"));
    expect_refused({"--revoke", "none"}, AllOf(HasSubstr("none.crt"), HasSubstr("cannot be read")));
    expect_refused({"--revoke", "server", "--client", "b"}, HasSubstr("excludes"));
    ASSERT_EQ(run(DISPARITYCTL, {"certificates", path("other"), "--client", "b"}).exit_code, 0);
    std::filesystem::copy_file(path("other/b.crt"), path("tls/b.crt"));
    ASSERT_EQ(make({"--client", "c"}).exit_code, 0);
    expect_refused({"--revoke", "c", "--revoke", "b"}, HasSubstr("of b is not of this authority"));
    expect_refused({"--revoke", "server"}, AllOf(HasSubstr("the daemon's own certificate"), HasSubstr("rename")));
    expect_refused({"--revoke", "authority"}, HasSubstr("which signs the list itself"));
    EXPECT_EQ(command_output("cat " + path("tls/authority.crt")).second, before);
    // What the line about a stolen server.key says can be done.
    for (const char* ending : {".crt", ".key"}) {
        std::filesystem::rename(path(std::string("tls/server") + ending), path(std::string("tls/stolen") + ending));
    }
    ASSERT_EQ(make({}).exit_code, 0);
    EXPECT_EQ(make({"--revoke", "stolen"}).exit_code, 0);
}

TEST_F(CertificatesTest, NamesThatCannotBeAreRefused) {
    for (const char* name : {"", "../a", "a/b", ".a", "authority", "server", "a b", "a\nb"}) {
        expect_refused({"--client", name}, HasSubstr("--client: found"));
    }
    expect_refused({"--client", "a", "--client", "a"}, HasSubstr("twice"));
    for (const char* host : {"a,DNS:b", "robot example", "\n", "röbot"}) {
        expect_refused({"--host", host}, HasSubstr("allowed: a name such as"));
    }
    expect_refused({"--days", "0"}, HasSubstr("--days"));
    EXPECT_TRUE(files().empty());
}

/// A daemon that other machines could reach, with these certificates.
class TlsDaemonTest : public CertificatesTest {
protected:
    void SetUp() override {
        CertificatesTest::SetUp();
        ASSERT_EQ(make({"--client", "guest", "--client", "pilot"}).exit_code, 0);
        std::filesystem::create_directory(path("recordings"));
        daemon_ = std::make_unique<DaemonProcess>(
            logs_, std::vector<std::string>{"--source",
                                            "scene:vga@30?width=128&height=96&loop=8",
                                            "--name",
                                            "dctl-tls-" + std::to_string(getpid()),
                                            "--print-address",
                                            "--set",
                                            "socket.unix=" + logs_.file("d.sock"),
                                            "--set",
                                            "socket.tcp=0.0.0.0:0",
                                            "--set",
                                            "socket.certificate=" + path("tls/server.crt"),
                                            "--set",
                                            "socket.key=" + path("tls/server.key"),
                                            "--set",
                                            "socket.client_authority=" + path("tls/authority.crt"),
                                            "--set",
                                            "access.control_certificates=[\"pilot\"]",
                                            "--set",
                                            "match.disparities=16",
                                            "--set",
                                            "record.directory=" + path("recordings")});
        ASSERT_TRUE(daemon_->wait_until_ready()) << daemon_->log();
        const std::string served = daemon_->address("tls:0.0.0.0:");
        ASSERT_FALSE(served.empty());
        address_ = "tls:127.0.0.1" + served.substr(served.rfind(':'));
    }

    void TearDown() override {
        daemon_->send_signal(SIGTERM);
        EXPECT_EQ(daemon_->wait_for_exit(), 0) << daemon_->log();
        CertificatesTest::TearDown();
    }

    Outcome ctl(const std::string& command, const std::string& certificate, std::vector<std::string> more = {}) const {
        more.insert(more.begin(), {command, "--socket", address_, "--authority", path("tls/authority.crt")});
        if (!certificate.empty()) {
            more.insert(more.end(), {"--certificate", path("tls/" + certificate + ".crt"), "--key",
                                     path("tls/" + certificate + ".key")});
        }
        return run(DISPARITYCTL, more);
    }

    TemporaryFolder logs_;
    std::unique_ptr<DaemonProcess> daemon_;
    std::string address_;
};

TEST_F(TlsDaemonTest, EveryCommandReachesIt) {
    EXPECT_THAT(ctl("status", "guest").out, HasSubstr("128 x 96"));
    EXPECT_EQ(ctl("watch", "guest", {"--count", "1"}).exit_code, 0);
    EXPECT_EQ(ctl("snapshot", "guest", {"--disparity", path("d.pfm")}).exit_code, 0);
    EXPECT_TRUE(std::filesystem::exists(path("d.pfm")));
}

TEST_F(TlsDaemonTest, WhoMayLookMayNotRecord) {
    const Outcome guest = ctl("record", "guest", {"a.mkv", "--frames", "3"});
    EXPECT_EQ(guest.exit_code, 1);
    EXPECT_THAT(guest.err, HasSubstr("control_certificates with the name \"guest\""));
    EXPECT_FALSE(std::filesystem::exists(path("recordings/a.mkv")));
    EXPECT_EQ(ctl("record", "pilot", {"a.mkv", "--frames", "3"}).exit_code, 0);
    EXPECT_TRUE(std::filesystem::exists(path("recordings/a.mkv")));
}

TEST_F(TlsDaemonTest, WhatIsWrongIsOneLine) {
    const auto error = [&](const Outcome& outcome) {
        EXPECT_NE(outcome.exit_code, 0);
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        return outcome.err;
    };
    EXPECT_THAT(error(ctl("status", "")), HasSubstr("certificate required"));
    EXPECT_THAT(error(run(DISPARITYCTL, {"status", "--socket", address_})),
                HasSubstr("signed by nobody who is trusted"));
    EXPECT_THAT(error(ctl("status", "none")), HasSubstr("none.crt"));
    EXPECT_THAT(error(run(DISPARITYCTL, {"status", "--socket", address_, "--key", path("tls/guest.key")})),
                HasSubstr("--certificate and --key go together"));
    EXPECT_THAT(error(run(DISPARITYCTL, {"status", "--authority", path("tls/authority.crt")})),
                HasSubstr("--authority: found without TLS"));
    EXPECT_THAT(error(run(DISPARITYCTL, {"status", "--socket", "tcp" + address_.substr(3)})), HasSubstr("TLS only"));
}

TEST_F(TlsDaemonTest, ARenewedCertificateIsReadAtAReload) {
    for (const char* ending : {"server.crt", "server.key"}) {
        std::filesystem::remove(path(std::string("tls/") + ending));
    }
    ASSERT_EQ(make({"--host", "localhost"}).exit_code, 0);
    daemon_->send_signal(SIGHUP);
    ASSERT_TRUE(eventually([&] { return ctl("status", "guest").exit_code != 0; })) << "127.0.0.1 is no longer in it";
    EXPECT_EQ(ctl("status", "guest", {"--server-name", "localhost"}).exit_code, 0);
    // One that cannot be used changes nothing.
    std::filesystem::remove(path("tls/server.key"));
    daemon_->send_signal(SIGHUP);
    ASSERT_TRUE(daemon_->wait_for_log("server.key")) << daemon_->log();
    EXPECT_EQ(ctl("status", "guest", {"--server-name", "localhost"}).exit_code, 0);
}

TEST_F(TlsDaemonTest, ARevokedCertificateIsRefusedAfterAReload) {
    ASSERT_EQ(make({"--revoke", "guest"}).exit_code, 0);
    daemon_->send_signal(SIGHUP);
    ASSERT_TRUE(eventually([&] { return ctl("status", "guest").exit_code != 0; }));
    EXPECT_THAT(ctl("status", "guest").err, HasSubstr("has taken this certificate back"));
    EXPECT_EQ(ctl("status", "pilot").exit_code, 0);
}

TEST_F(CertificatesTest, ADaemonRefusesWhatCannotBeUsed) {
    ASSERT_EQ(make({"--client", "a"}).exit_code, 0);
    const auto check = [&](const std::vector<std::string>& settings, const testing::Matcher<std::string>& says) {
        std::vector<std::string> arguments{"--check", "--source", "scene:vga@30?width=128&height=96&loop=8"};
        for (const std::string& setting : settings) {
            arguments.insert(arguments.end(), {"--set", setting});
        }
        const Outcome outcome = run(DISPARITYD_PROGRAM, arguments);
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_THAT(outcome.err, says);
    };
    const std::string certificate = "socket.certificate=" + path("tls/server.crt");
    const std::string key = "socket.key=" + path("tls/server.key");
    check({certificate, "socket.key=" + path("tls/a.key")},
          AllOf(HasSubstr("[socket] "), HasSubstr("a.key"), HasSubstr("mismatch")));
    check({certificate, "socket.key=" + path("none")}, AllOf(HasSubstr("none"), HasSubstr("cannot be read")));
    check({"socket.certificate=" + path("tls/server.key"), key}, HasSubstr("the certificate cannot be used"));
    check({certificate, key, "socket.client_authority=" + path("tls/a.key")}, HasSubstr("the authority's certificate"));
    check({"socket.tokens=" + path("none")}, AllOf(HasSubstr("[socket] tokens"), HasSubstr("cannot be read")));
    check({"access.control_groups=[\"no-such-group\"]"}, HasSubstr("[access] control_groups"));
    check({certificate, key, "socket.tcp=0.0.0.0:9876"}, HasSubstr("one of client_authority and tokens"));
    check({"socket.certificate=" + path("tls/a.crt"), "socket.key=" + path("tls/a.key")},
          AllOf(HasSubstr("a.crt"), HasSubstr("for another purpose than a server's")));
    ASSERT_EQ(make({"--revoke", "a"}).exit_code, 0);
    const std::string authority = command_output("cat " + path("tls/authority.crt")).second;
    const std::string list = path("list.crt");
    std::ofstream(list) << authority.substr(authority.find("-----BEGIN X509 CRL"));
    check({certificate, key, "socket.client_authority=" + list},
          AllOf(HasSubstr("list.crt"), HasSubstr("a list of revoked certificates only")));
    ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
    check({"socket.certificate=" + path("pipe"), key}, HasSubstr("pipe: is not a regular file"));
    check({certificate, "socket.key=" + path("pipe")}, HasSubstr("the key is not a regular file"));
    check({certificate, key, "socket.client_authority=" + path("pipe")}, HasSubstr("pipe: is not a regular file"));
    check({"socket.tokens=" + path("pipe")}, HasSubstr("the tokens is not a regular file"));
    ASSERT_EQ(chmod(path("tls/server.key").c_str(), 0644), 0);
    check({certificate, key}, AllOf(HasSubstr("every user may read the key"), HasSubstr("chmod o-rw")));
}

}  // namespace
}  // namespace disparityd::test
