// SPDX-License-Identifier: Apache-2.0
#include "lab/handover/reader_process.h"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <exception>
#include <map>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "clients/cpp/disparity_client.hpp"
#include "proto/monotonic_clock.h"
#include "tools/command_line/program.h"

namespace disparityd::handover {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// What a client does at least with a frame: it reads each depth once.
std::uint64_t sum_of(const std::uint8_t* bytes, std::size_t size) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i + 1 < size; i += 2) {
        std::uint16_t depth = 0;
        std::memcpy(&depth, bytes + i, 2);
        sum += depth;
    }
    return sum;
}

/// Keeps the compiler from leaving out what nobody looks at.
void keep(std::uint64_t value) {
    asm volatile("" : : "r"(value));
}

void check(disparity::ReadResult result, const std::string& why_gone) {
    if (result == disparity::ReadResult::gone) {
        throw std::runtime_error(why_gone);
    }
}

/// When a frame came and when it had been published; 0 where there was no frame, or where that is not known.
struct Arrival {
    std::int64_t came_ns = 0;
    std::int64_t published_ns = 0;
};

/// Reads until the time is over. `read` gives arrivals, and `use` works with the frame.
template <typename AnyFrame, typename Read, typename Use>
void read_frames(const ReaderOptions& options, Seen& seen, const AnyFrame& frame, Read read, Use use) {
    const auto end = Clock::now() + std::chrono::duration<double>(options.seconds);
    bool first = true;
    while (Clock::now() < end) {
        const Arrival arrival = read();
        if (arrival.came_ns == 0) {
            continue;
        }
        // The first one had been published before this reader came.
        if (!first) {
            seen.skipped += frame.skipped;
            if (arrival.published_ns != 0) {
                seen.handover_ns.push_back(arrival.came_ns - arrival.published_ns);
            } else {
                ++seen.untimed;
            }
        }
        first = false;
        use();
    }
}

template <typename AnyFrame>
void add_up_depth(const AnyFrame& frame) {
    if (const auto* depth = frame.plane(disparity::Product::depth); depth != nullptr) {
        keep(sum_of(depth->bytes.data(), depth->bytes.size()));
    }
}

std::int64_t published_ns(const disparity::FrameInfo& of_shared_memory) {
    return of_shared_memory.monotonic_ns + of_shared_memory.sent_age_ns;
}

/// Of a frame that `reader` may have given.
Arrival arrival(disparity::ReadResult result, const disparity::SharedMemoryReader& reader,
                const disparity::FrameInfo& frame) {
    const std::int64_t now = proto::monotonic_ns();
    check(result, reader.why_gone());
    return result == disparity::ReadResult::frame ? Arrival{now, published_ns(frame)} : Arrival{};
}

Seen read_copies(const ReaderOptions& options) {
    Seen seen;
    disparity::Frame frame;
    disparity::SharedMemoryReader reader(options.name);
    read_frames(
        options, seen, frame, [&] { return arrival(reader.read(frame, 500ms), reader, frame); },
        [&] { add_up_depth(frame); });
    return seen;
}

Seen read_borrowed(const ReaderOptions& options) {
    Seen seen;
    disparity::BorrowedFrame frame;
    disparity::SharedMemoryReader reader(options.name);
    const auto use = [&] {
        add_up_depth(frame);
        seen.torn += frame.whole() ? 0U : 1U;
    };
    read_frames(
        options, seen, frame, [&] { return arrival(reader.borrow(frame, 500ms), reader, frame); }, use);
    return seen;
}

/// A frame of the socket says when it was sent; the shared memory says when the same frame was published.
class PublishTimes {
public:
    explicit PublishTimes(const std::string& name) : reader_(name) {}

    /// Waits for a first frame, and returns what it carries.
    std::vector<disparity::Product> products() {
        disparity::ReadResult result = disparity::ReadResult::timeout;
        while (result != disparity::ReadResult::frame) {
            result = reader_.borrow(newest_, 500ms);
            check(result, reader_.why_gone());
        }
        std::vector<disparity::Product> found;
        for (const disparity::BorrowedPlane& plane : newest_.planes) {
            found.push_back(plane.product);
        }
        return found;
    }

    /// 0 where a newer frame was published before this was asked for the one before it.
    std::int64_t of(std::uint64_t publish_index) {
        while (reader_.borrow(newest_, 0ms) == disparity::ReadResult::frame) {
            times_[newest_.publish_index] = published_ns(newest_);
        }
        times_.erase(times_.begin(), times_.lower_bound(publish_index));
        const auto found = times_.find(publish_index);
        return found == times_.end() ? 0 : found->second;
    }

private:
    disparity::SharedMemoryReader reader_;
    disparity::BorrowedFrame newest_;
    std::map<std::uint64_t, std::int64_t> times_;
};

Seen read_socket(const ReaderOptions& options) {
    Seen seen;
    disparity::Frame frame;
    PublishTimes times(options.name);
    disparity::SocketClient client(options.address, "disparity-handover");
    disparity::Subscription subscription;
    subscription.products = times.products();
    client.subscribe(subscription);
    const auto read = [&]() -> Arrival {
        const disparity::ReadResult result = client.read(frame, 500ms);
        const std::int64_t now = proto::monotonic_ns();
        check(result, client.why_gone());
        return result == disparity::ReadResult::frame ? Arrival{now, times.of(frame.publish_index)} : Arrival{};
    };
    read_frames(options, seen, frame, read, [&] { add_up_depth(frame); });
    return seen;
}

/// Only on the daemon's own machine: its clock is this one's.
Seen read_and_work(const ReaderOptions& options) {
    Seen seen;
    disparity::Frame frame;
    disparity::SocketClient client(options.address, options.connect, "disparity-handover");
    disparity::Subscription subscription;
    subscription.products = options.products;
    client.subscribe(subscription);
    const auto end = Clock::now() + std::chrono::duration<double>(options.seconds);
    while (Clock::now() < end) {
        const disparity::ReadResult result = client.read(frame, 500ms);
        const std::int64_t now = proto::monotonic_ns();
        check(result, client.why_gone());
        if (result != disparity::ReadResult::frame) {
            continue;
        }
        const std::int64_t age = now - frame.monotonic_ns;
        seen.skipped += seen.age_ns.empty() ? 0 : frame.skipped;
        seen.age_ns.push_back(age);
        seen.told_less_ns.push_back(frame.age_ns - age);
        std::this_thread::sleep_for(std::chrono::duration<double>(options.work_s));
    }
    return seen;
}

Seen run(const ReaderOptions& options) {
    switch (options.way) {
        case Way::copy: return read_copies(options);
        case Way::borrow: return read_borrowed(options);
        case Way::socket: return read_socket(options);
        case Way::work: break;
    }
    return read_and_work(options);
}

void write_all(int to, const void* data, std::size_t bytes) {
    const auto* from = static_cast<const char*>(data);
    while (bytes > 0) {
        const ssize_t written = ::write(to, from, bytes);
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written <= 0) {
            throw std::system_error(errno, std::generic_category(), "results of a reader cannot be written");
        }
        from += written;
        bytes -= static_cast<std::size_t>(written);
    }
}

/// Returns whether all came.
bool read_all(int from, void* data, std::size_t bytes) {
    auto* to = static_cast<char*>(data);
    while (bytes > 0) {
        const ssize_t got = ::read(from, to, bytes);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got <= 0) {
            return false;
        }
        to += got;
        bytes -= static_cast<std::size_t>(got);
    }
    return true;
}

void send(int to, const Seen& seen) {
    const std::uint64_t counts[3] = {seen.skipped, seen.torn, seen.untimed};
    write_all(to, counts, sizeof counts);
    for (const auto* times : {&seen.handover_ns, &seen.age_ns, &seen.told_less_ns}) {
        const std::uint64_t size = times->size();
        write_all(to, &size, sizeof size);
        write_all(to, times->data(), times->size() * sizeof(std::int64_t));
    }
}

/// Returns whether all came.
bool receive(int from, Seen& seen) {
    std::uint64_t counts[3] = {};
    if (!read_all(from, counts, sizeof counts)) {
        return false;
    }
    seen.skipped = counts[0];
    seen.torn = counts[1];
    seen.untimed = counts[2];
    for (auto* times : {&seen.handover_ns, &seen.age_ns, &seen.told_less_ns}) {
        std::uint64_t size = 0;
        if (!read_all(from, &size, sizeof size)) {
            return false;
        }
        times->resize(size);
        if (!read_all(from, times->data(), times->size() * sizeof(std::int64_t))) {
            return false;
        }
    }
    return true;
}

}  // namespace

ReaderProcess::ReaderProcess(const ReaderOptions& options) {
    int ends[2] = {-1, -1};
    if (::pipe(ends) != 0) {
        throw std::system_error(errno, std::generic_category(), "a reader cannot be started");
    }
    pid_ = ::fork();
    if (pid_ < 0) {
        const int reason = errno;
        ::close(ends[0]);
        ::close(ends[1]);
        throw std::system_error(reason, std::generic_category(), "a reader cannot be started");
    }
    if (pid_ == 0) {
        ::close(ends[0]);
        try {
            send(ends[1], run(options));
        } catch (const std::exception& error) {
            tools::print_error(error.what());
            ::_exit(1);
        }
        ::_exit(0);
    }
    ::close(ends[1]);
    results_ = ends[0];
}

ReaderProcess::~ReaderProcess() {
    ::close(results_);
    if (pid_ > 0) {
        ::kill(pid_, SIGKILL);
        ::waitpid(pid_, nullptr, 0);
    }
}

Seen ReaderProcess::wait() {
    Seen seen;
    const bool whole = receive(results_, seen);
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    if (!whole || status != 0) {
        throw std::runtime_error("a reader has failed");
    }
    return seen;
}

}  // namespace disparityd::handover
