// SPDX-License-Identifier: Apache-2.0
//
// disparity::connect(): which way leads to a daemon, what comes over it, and how it is found again.
#include <cstdlib>
#include <filesystem>
#include <future>

#include <disparity_client.hpp>
#include <gmock/gmock.h>
#include <unistd.h>

#include "proto/frame_message.h"
#include "tests/proto/fake_daemon.h"
#include "tests/proto/pattern.h"
#include "tests/proto/sensor_pattern.h"
#include "tests/temporary_folder.h"

namespace proto = disparityd::proto;
namespace v1 = disparityd::v1;
using namespace std::chrono_literals;
using disparity::Client;
using disparity::Frame;
using disparity::Product;
using disparity::ReadResult;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

namespace {

disparity::Subscription products(std::vector<Product> wanted) {
    disparity::Subscription subscription;
    subscription.products = std::move(wanted);
    return subscription;
}

disparity::ClientOptions absent() {
    disparity::ClientOptions options;
    options.may_be_absent = true;
    return options;
}

/// Reads past what the machine is too busy for.
ReadResult patient_read(Client& client, Frame& frame, ReadResult unwanted = ReadResult::timeout) {
    const auto end = std::chrono::steady_clock::now() + 60s;
    ReadResult result = client.read(frame, 1s);
    while (result == unwanted && std::chrono::steady_clock::now() < end) {
        result = client.read(frame, 1s);
    }
    return result;
}

/// The shared memory of a daemon that lives.
class Memory {
public:
    explicit Memory(const std::string& name) : writer_(name, layout_) {
        heart_ = std::jthread([this](const std::stop_token& stop) {
            while (!stop.stop_requested()) {
                writer_.heartbeat();
                std::this_thread::sleep_for(100ms);
            }
        });
    }
    void publish(std::uint64_t sequence) {
        pattern::Source source(layout_);
        writer_.publish(pattern::head(sequence, layout_), source.make(sequence));
    }

private:
    proto::ShmLayout layout_ = pattern::layout(16, 8);
    proto::SharedMemoryWriter writer_;
    std::jthread heart_;
};

/// A frame with nothing but its numbers.
v1::Envelope bare_frame(std::uint64_t sequence) {
    v1::Envelope envelope;
    proto::fill(*envelope.mutable_frame(), pattern::head(sequence, pattern::layout(16, 8)));
    return envelope;
}

class FrontDoor : public testing::Test {
protected:
    FrontDoor() { setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1); }
    ~FrontDoor() override { unsetenv("XDG_RUNTIME_DIR"); }

    /// Puts the socket where a daemon of this name has it.
    void name_socket(const FakeDaemon& daemon, const std::string& name) const {
        std::filesystem::rename(daemon.unix_address().substr(5), folder_.file("disparityd-" + name + ".sock"));
    }

    disparityd::test::TemporaryFolder folder_;
    std::string name_ = pattern::unique_name("door", ::getpid());
};

TEST_F(FrontDoor, ByNameLeadsToTheSharedMemory) {
    Memory memory(name_);
    memory.publish(5);
    Client client = disparity::connect(name_, products({Product::confidence}));
    EXPECT_EQ(client.where(), "shared memory " + name_);
    Frame frame;
    ASSERT_EQ(patient_read(client, frame), ReadResult::frame);
    EXPECT_EQ(frame.sequence, 5U);
    ASSERT_EQ(frame.planes.size(), 1U) << "what was not wanted is not copied";
    EXPECT_EQ(client.read(frame, 0ms), ReadResult::timeout);
}

TEST_F(FrontDoor, FindsTheNextDaemonOfTheName) {
    auto memory = std::make_unique<Memory>(name_);
    memory->publish(5);
    Client client = disparity::connect(name_);
    Frame frame;
    ASSERT_EQ(patient_read(client, frame), ReadResult::frame);
    memory.reset();
    EXPECT_EQ(patient_read(client, frame), ReadResult::gone);
    EXPECT_THAT(client.why_gone(), HasSubstr("/disparityd." + name_));
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(client.read(frame, 150ms), ReadResult::gone);
    EXPECT_GE(std::chrono::steady_clock::now() - begin, 149ms) << "a loop that reads on must not take a whole core";
    EXPECT_EQ(client.where(), "");
    memory = std::make_unique<Memory>(name_);
    memory->publish(1);
    ASSERT_EQ(patient_read(client, frame, ReadResult::gone), ReadResult::frame);
    EXPECT_EQ(frame.sequence, 1U);
}

TEST_F(FrontDoor, WaitsForADaemonThatMayBeAbsent) {
    EXPECT_THAT([&] { disparity::connect(name_); },
                ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("no daemon answers"), HasSubstr("named " + name_),
                                                        HasSubstr("shared memory /disparityd." + name_))));
    Client client = disparity::connect(name_, {}, absent());
    Frame frame;
    EXPECT_EQ(client.read(frame, 0ms), ReadResult::gone);
    EXPECT_THAT(client.why_gone(), HasSubstr("no daemon answers"));
    Memory memory(name_);
    memory.publish(2);
    EXPECT_EQ(patient_read(client, frame, ReadResult::gone), ReadResult::frame);
}

TEST_F(FrontDoor, GoesOnOverTheSharedMemoryOnceThereIsOne) {
    std::promise<void> published;
    std::promise<v1::Subscribe> second;
    FakeDaemon daemon([&](ServerEnd& end) {
        end.greet();
        v1::Envelope subscribe;
        end.receive(subscribe);
        published.get_future().wait();
        end.send(bare_frame(5));
        end.receive(subscribe);
        second.set_value(subscribe.subscribe());
        end.receive(subscribe);  // the client goes
    });
    name_socket(daemon, name_);
    Client client = disparity::connect(name_);
    EXPECT_EQ(client.where(), "socket of " + name_);
    Memory memory(name_);
    memory.publish(5);
    memory.publish(6);
    published.set_value();
    Frame frame;
    ASSERT_EQ(patient_read(client, frame), ReadResult::frame);
    EXPECT_EQ(frame.sequence, 6U) << "the newest one wins";
    EXPECT_EQ(frame.skipped, 1U);
    EXPECT_EQ(client.where(), "shared memory " + name_);
    EXPECT_EQ(second.get_future().get().products_size(), 0);
    memory.publish(7);
    ASSERT_EQ(patient_read(client, frame), ReadResult::frame);
    EXPECT_EQ(frame.sequence, 7U);
}

TEST_F(FrontDoor, HasSensorsAndStatusBesideTheSharedMemory) {
    Memory memory(name_);
    FakeDaemon daemon([](ServerEnd& end) {
        end.greet();
        v1::Envelope request;
        while (end.receive(request)) {
            v1::Envelope answer;
            if (request.has_status_request()) {
                answer.mutable_status()->set_state("running");
                end.send(answer);
            } else if (request.subscribe().sensors()) {
                EXPECT_EQ(request.subscribe().products_size(), 0);
                end.send(sensor_message());
            }
        }
    });
    name_socket(daemon, name_);
    disparity::Subscription wanted = products({Product::disparity});
    wanted.sensors = true;
    Client client = disparity::connect(name_, wanted);
    disparity::SensorBatch batch;
    ASSERT_EQ(client.read_sensors(batch, 60s), ReadResult::frame);
    EXPECT_EQ(batch.samples.size(), 2U);
    v1::Status status;
    ASSERT_TRUE(status.ParseFromString(client.status(60s)));
    EXPECT_EQ(status.state(), "running");
    EXPECT_EQ(client.where(), "shared memory " + name_);
    memory.publish(1);
    Frame frame;
    EXPECT_EQ(patient_read(client, frame), ReadResult::frame);
}

TEST_F(FrontDoor, ARegionComesOverTheSocket) {
    Memory memory(name_);
    std::promise<v1::Subscribe> told;
    FakeDaemon daemon([&](ServerEnd& end) {
        end.greet();
        v1::Envelope subscribe;
        end.receive(subscribe);
        told.set_value(subscribe.subscribe());
        end.receive(subscribe);
    });
    name_socket(daemon, name_);
    Client client = disparity::connect(name_);
    EXPECT_EQ(client.where(), "shared memory " + name_);
    disparity::Subscription part;
    part.region_width = 4;
    part.region_height = 4;
    client.subscribe(part);
    Frame frame;
    EXPECT_EQ(patient_read(client, frame, ReadResult::gone), ReadResult::timeout);
    EXPECT_EQ(client.where(), "socket of " + name_);
    EXPECT_EQ(told.get_future().get().region().width(), 4U);
}

TEST_F(FrontDoor, KeepsTheRateOverTheSharedMemory) {
    Memory memory(name_);
    disparity::Subscription slow;
    slow.max_rate = 0.001;
    Client client = disparity::connect(name_, slow);
    memory.publish(1);
    Frame frame;
    ASSERT_EQ(patient_read(client, frame), ReadResult::frame);
    memory.publish(2);
    EXPECT_EQ(client.read(frame, 10ms), ReadResult::timeout);
    client.subscribe({});
    EXPECT_EQ(patient_read(client, frame), ReadResult::frame);
}

TEST_F(FrontDoor, WithoutANameLeadsToTheDaemonThatRunsOrNamesThem) {
    const auto stay = [](ServerEnd& end) {
        end.greet();
        v1::Envelope none;
        end.receive(none);
    };
    FakeDaemon front(stay);
    FakeDaemon back(stay);
    name_socket(front, name_ + ".front");
    name_socket(back, name_ + ".back");
    try {
        EXPECT_EQ(disparity::connect("", products({})).where(), "socket of default") << "another daemon runs here";
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), AllOf(HasSubstr("several daemons run on this machine: "),
                                        HasSubstr(name_ + ".back, "), HasSubstr(name_ + ".front")));
    }
    std::filesystem::rename(folder_.file("disparityd-" + name_ + ".front.sock"), folder_.file("disparityd.sock"));
    EXPECT_EQ(disparity::connect("", products({})).where(), "socket of default");
}

TEST_F(FrontDoor, RefusesWhatItCannotBeTold) {
    for (const char* where : {"a b", "tcp:", "tcp:host", "unix:", "http:x"}) {
        EXPECT_THROW(disparity::connect(where, {}, absent()), std::invalid_argument) << where;
    }
    disparity::Subscription pushed;
    pushed.status_interval_s = 1;
    EXPECT_THAT([&] { disparity::connect(name_, pushed); },
                ThrowsMessage<std::invalid_argument>(HasSubstr("ask with status()")));
    disparity::Subscription backwards;
    backwards.max_rate = -1;
    EXPECT_THROW(disparity::connect(name_, backwards), std::invalid_argument);
}

TEST_F(FrontDoor, BeginsAnewAfterARefusal) {
    int connections = 0;
    FakeDaemon daemon([&](ServerEnd& end) {
        end.greet();
        v1::Envelope subscribe;
        if (!end.receive(subscribe)) {
            return;
        }
        v1::Envelope answer = bare_frame(3);
        if (++connections == 1) {
            answer.mutable_error()->set_message("no such product");
        }
        end.send(answer);
        end.receive(subscribe);
    });
    Client client = disparity::connect(daemon.unix_address());
    EXPECT_EQ(client.where(), daemon.unix_address());
    Frame frame;
    EXPECT_THAT([&] { patient_read(client, frame); }, ThrowsMessage<std::runtime_error>(HasSubstr("no such product")));
    EXPECT_EQ(patient_read(client, frame, ReadResult::gone), ReadResult::frame);
}

}  // namespace
