// SPDX-License-Identifier: Apache-2.0
//
// What a client library believes: a shared-memory object when the input begins as one, else the bytes of a socket.
#include <cstring>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "clients/cpp/frame_message.h"
#include "clients/cpp/message_stream.h"
#include "proto/shared_memory_reader.h"
#include "tests/fuzz/outcome.h"

namespace fuzz = disparityd::fuzz;
namespace proto = disparityd::proto;

namespace {

void read_shared_memory(const std::uint8_t* data, std::size_t size) {
    static const std::string name = "fuzz-" + std::to_string(::getpid());
    const std::string object = proto::shm_object_name(name);
    const int file = ::shm_open(object.c_str(), O_RDWR | O_CREAT | O_TRUNC, 0600);
    fuzz::expect(file >= 0 && ::write(file, data, size) == static_cast<ssize_t>(size), "shared memory");
    ::close(file);
    fuzz::accepted<std::runtime_error>("shared memory " + object, [&] {
        proto::ShmReader reader(name);
        std::vector<std::uint8_t> plane;
        proto::FrameInfo frame{};
        reader.read(
            frame,
            [&](const proto::ShmPlane& wanted) {
                fuzz::expect(wanted.bytes <= size, "a plane larger than the memory that holds it");
                plane.resize(wanted.bytes);
                return plane.data();
            },
            std::chrono::nanoseconds(0));
    });
    ::shm_unlink(object.c_str());
}

/// A listening socket without a name in the file system would need another address than clients take.
class Daemon {
public:
    Daemon() : path_("/tmp/disparityd-fuzz-" + std::to_string(::getpid()) + ".sock") {
        sockaddr_un name{};
        name.sun_family = AF_UNIX;
        std::strncpy(name.sun_path, path_.c_str(), sizeof name.sun_path - 1);
        listener_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
        fuzz::expect(::bind(listener_, reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0 &&
                         ::listen(listener_, 1) == 0,
                     "listening socket");
    }
    ~Daemon() {
        ::close(listener_);
        ::unlink(path_.c_str());
    }
    Daemon(const Daemon&) = delete;
    Daemon& operator=(const Daemon&) = delete;

    std::string address() const { return "unix:" + path_; }

    /// To the client that has connected.
    void say(const std::uint8_t* data, std::size_t size) const {
        const int client = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
        fuzz::expect(client >= 0, "accept");
        static_cast<void>(::send(client, data, size, MSG_NOSIGNAL));  // what does not fit is cut off: an input, too
        ::close(client);
    }

private:
    std::string path_;
    int listener_ = -1;
};

void read_socket(const std::uint8_t* data, std::size_t size) {
    static const Daemon daemon;
    const auto deadline = disparity::after(std::chrono::seconds(5));
    disparity::MessageStream stream(daemon.address(), deadline);
    daemon.say(data, size);
    fuzz::accepted("", [&] {
        disparity::Frame frame;
        while (stream.receive(deadline) == disparity::Transport::Outcome::done) {
            if (stream.envelope().has_frame()) {
                disparity::take_over(frame, stream.envelope().frame(), stream.payload());
            }
        }
    });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size >= sizeof proto::shm_magic && std::memcmp(data, &proto::shm_magic, sizeof proto::shm_magic) == 0) {
        read_shared_memory(data, size);
    } else {
        read_socket(data, size);
    }
    return 0;
}
