// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include <gmock/gmock.h>

#include "bridges/web/options.h"

namespace disparityd::web {
namespace {

using ::testing::HasSubstr;

std::string error_of(const Options& options) {
    try {
        options.settings();
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

Options at(const std::string& listen) {
    Options options;
    options.listen = listen;
    return options;
}

TEST(WebOptionsTest, AnAddressAndAPort) {
    EXPECT_EQ(at("127.0.0.1:8765").settings().port, 8765);
    EXPECT_EQ(at("[::1]:0").settings().host, "::1");
    for (const char* wrong : {"", ":", "8765", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "127.0.0.1:-1",
                              "127.0.0.1:8765x", "robot:8765", "::1", "[::1]"}) {
        EXPECT_THAT(error_of(at(wrong)), HasSubstr("--listen: found \"" + std::string(wrong) + "\", allowed: "))
            << wrong;
    }
}

TEST(WebOptionsTest, BeyondThisMachineOnlyWithTlsAndVisitorsThatAreKnown) {
    for (const char* listen : {"0.0.0.0:8765", "[::]:8765", "192.168.1.5:8765"}) {
        Options options = at(listen);
        EXPECT_THAT(error_of(options), HasSubstr("other machines could look at the camera")) << listen;
        options.certificate = "c.pem";
        options.key = "k.pem";
        EXPECT_THAT(error_of(options), HasSubstr("other machines could look")) << "nobody knows who looks";
        options.client_authority = "a.pem";
        EXPECT_EQ(error_of(options), "");
    }
    Options plain = at("0.0.0.0:8765");
    plain.insecure = true;
    EXPECT_EQ(error_of(plain), "");
}

TEST(WebOptionsTest, AllDaemonsOrTheOneThatIsMeant) {
    Options options;
    EXPECT_FALSE(options.settings().all);
    options.all = true;
    EXPECT_TRUE(options.settings().all);
    Options named = options;
    named.daemon.name = "front";
    EXPECT_THAT(error_of(named), HasSubstr("--all: found with --name"));
    Options elsewhere = options;
    elsewhere.daemon.socket = "tcp:127.0.0.1:9876";
    EXPECT_THAT(error_of(elsewhere), HasSubstr("--all: found with"));
    Options with_token = options;
    with_token.daemon.reach.options.token_file = "token";
    EXPECT_THAT(error_of(with_token), HasSubstr("--all: found with"));
}

TEST(WebOptionsTest, FilesOfTlsGoTogether) {
    Options options;
    options.certificate = "c.pem";
    EXPECT_THAT(error_of(options), HasSubstr("--certificate and --key go together"));
    options = {};
    options.client_authority = "a.pem";
    EXPECT_THAT(error_of(options), HasSubstr("--client-authority needs"));
}

TEST(WebOptionsTest, TheSocketHasItsForm) {
    Options options;
    options.daemon.socket = "/run/d.sock";
    EXPECT_EQ(options.settings().daemon.where, "/run/d.sock");
    options.daemon.socket = "robot";
    EXPECT_THAT(error_of(options), HasSubstr("--socket: found 'robot', allowed: "));
}

TEST(WebOptionsTest, WhatNoBrowserSendsIsNoOriginAndNoHost) {
    Options options;
    options.origins = {"https://app.example.org", "x"};
    EXPECT_THAT(error_of(options), HasSubstr("--origin: found \"x\", allowed: SCHEME://HOST"));
    options.origins = {"https://app.example.org/"};
    EXPECT_THAT(error_of(options), HasSubstr("--origin: found \"https://app.example.org/\""));
    options.origins = {"https://app.example.org", "file://"};
    options.hosts = {"robot.example.org"};
    EXPECT_EQ(error_of(options), "");
    for (const char* wrong : {"http://robot", "robot:8765", "robot/", ""}) {
        options.hosts = {wrong};
        EXPECT_THAT(error_of(options), HasSubstr("--host: found \"" + std::string(wrong) + "\", allowed: ")) << wrong;
    }
}

TEST(WebOptionsTest, ConnectionsFitToTheDescriptors) {
    ServerSettings settings;
    settings.max_connections = 128;
    EXPECT_EQ(fit_to_descriptors(settings, 1024), "");
    EXPECT_EQ(fit_to_descriptors(settings, 160), "");
    EXPECT_EQ(settings.max_connections, 128);
    EXPECT_THAT(fit_to_descriptors(settings, 100),
                HasSubstr("may open 100 files, needed: 160 for --max-connections 128; only 68 connections are served"));
    EXPECT_EQ(settings.max_connections, 68);
    EXPECT_THROW(fit_to_descriptors(settings, 39), std::runtime_error);
    settings.all = true;
    EXPECT_THROW(fit_to_descriptors(settings, 100), std::runtime_error) << "each daemon needs some";
}

TEST(WebOptionsTest, ADaemonElsewhereIsReachedOverTls) {
    Options options;
    options.daemon.socket = "tls:robot.local:9876";
    options.daemon.reach.options.authority = "authority.crt";
    options.daemon.reach.options.token_file = "token";
    const ServerSettings settings = options.settings();
    EXPECT_EQ(settings.daemon.where, "tls:robot.local:9876");
    EXPECT_EQ(settings.daemon.options.authority, "authority.crt");
    EXPECT_EQ(settings.daemon.options.token_file, "token");
    options.daemon.socket = "tcp:127.0.0.1:9876";
    EXPECT_THAT(error_of(options), HasSubstr("authority: found without TLS"));
}

}  // namespace
}  // namespace disparityd::web
