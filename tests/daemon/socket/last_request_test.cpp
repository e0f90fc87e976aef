// SPDX-License-Identifier: Apache-2.0
//
// A client that goes right after a request, while the daemon has something else to tell it: the request is done.
#include <thread>

#include <sys/socket.h>

#include "tests/certificate_folder.h"
#include "tests/daemon/socket/server_fixture.h"
#include "tests/daemon/tls_wire_client.h"

namespace disparityd::test {
namespace {

using namespace std::chrono_literals;

class LastRequestTest : public ServerTest {
protected:
    void SetUp() override {
        before_status_ = [this] {
            if (hold_.exchange(false)) {
                held_.set_value();
                go_on_.get_future().wait();
            }
        };
        config_.access.tcp_control = true;
    }

    /// Has the server work on an answer while the client says its last words and is gone.
    void leave_behind(std::unique_ptr<WireClient> client, const std::vector<v1::Envelope>& last) {
        const auto welcome = client->hello();
        ASSERT_TRUE(welcome && welcome->has_welcome());
        hold_ = true;
        v1::Envelope question;
        question.mutable_status_request();
        ASSERT_TRUE(client->send(question));
        ASSERT_EQ(held_.get_future().wait_for(60s), std::future_status::ready);
        for (const v1::Envelope& message : last) {
            ASSERT_TRUE(client->send(message));
        }
        const linger at_once{1, 0};  // over TCP the next write fails, as on the Unix socket
        ASSERT_EQ(setsockopt(client->descriptor(), SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once), 0);
        client.reset();
        go_on_.set_value();
    }

    /// Waits until the server has closed the client's connection.
    bool forgotten() const {
        for (int i = 0; i < 6000 && server_->gone() == 0; ++i) {
            std::this_thread::sleep_for(10ms);
        }
        return server_->gone() == 1;
    }

    std::atomic<bool> hold_{false};
    std::promise<void> held_;
    std::promise<void> go_on_;
};

std::vector<v1::Envelope> camera_and_stop() {
    std::vector<v1::Envelope> last(2);
    last[0].mutable_camera_request()->add_settings()->set_name("gain-left");
    last[1].mutable_record_stop();
    return last;
}

TEST_F(LastRequestTest, OnTheUnixSocketIsDone) {
    start();
    leave_behind(std::make_unique<WireClient>(unix_), camera_and_stop());
    EXPECT_TRUE(forgotten());
    EXPECT_EQ(stops_, 1);
}

TEST_F(LastRequestTest, OverTcpIsDone) {
    start();
    leave_behind(std::make_unique<WireClient>(tcp_), camera_and_stop());
    EXPECT_TRUE(forgotten());
    EXPECT_EQ(stops_, 1);
}

TEST_F(LastRequestTest, OverTlsIsDone) {
    const CertificateFolder files;
    config_.tls = proto::make_server_tls(files.server(false), "test");
    start();
    leave_behind(std::make_unique<TlsWireClient>(tcp_, files.client("")), camera_and_stop());
    EXPECT_TRUE(forgotten());
    EXPECT_EQ(stops_, 1);
}

TEST_F(LastRequestTest, OfAClientThatTakesNoAnswersKeepsNoPlace) {
    start();
    WireClient client = connect(unix_);
    ASSERT_EQ(shutdown(client.descriptor(), SHUT_RD), 0);
    v1::Envelope question;
    question.mutable_status_request();
    ASSERT_TRUE(client.send(question));
    EXPECT_TRUE(forgotten());
}

}  // namespace
}  // namespace disparityd::test
