// SPDX-License-Identifier: Apache-2.0
//
// soak_reader ADDRESS MANNER: reads frames with the C++ client until its standard input ends, then one more, and prints
// its account. The first frame is announced by the line "frame".
//   shm:NAME            copy, borrow
//   tcp:..., unix:PATH  raw, everything, zstd, region
#include <chrono>
#include <cstdio>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "clients/cpp/disparity_client.hpp"
#include "proto/disparity.pb.h"
#include "tests/soak/reader_account.h"

namespace disparityd::test {
namespace {

using disparity::Frame;
using disparity::FrameInfo;
using disparity::Product;
using disparity::ReadResult;
using std::chrono::steady_clock;

SeenFrame seen(const FrameInfo& frame) {
    return {frame.publish_index, frame.sequence, frame.dropped_before,
            frame.skipped,       frame.age_ns,   (frame.flags & disparity::discontinuity) != 0};
}

/// Every plane has as many bytes as its size says.
template <typename AnyFrame>
void check_planes(const AnyFrame& frame) {
    for (const auto& plane : frame.planes) {
        const std::uint64_t expected = std::uint64_t{plane.width} * plane.height * plane.bytes_per_pixel;
        if (plane.bytes.size() != expected) {
            throw std::logic_error("a plane of frame " + std::to_string(frame.publish_index) + " has " +
                                   std::to_string(plane.bytes.size()) + " bytes, expected " + std::to_string(expected));
        }
    }
}

/// Returns nothing, and adds the refusal, when `next` throws one.
template <typename Next>
std::optional<SeenFrame> frame_or_refusal(Next& next, ReaderAccount& account) {
    try {
        return next();
    } catch (const std::runtime_error& refusal) {
        account.add_refusal(refusal.what());
        return std::nullopt;
    }
}

/// Reads with `next` until the end is asked for, then one frame more. After a reload without a product that was
/// subscribed to, the client throws once, and frames go on.
template <typename Next>
ReaderAccount follow(Next next) {
    ReaderAccount account;
    std::optional<steady_clock::time_point> end_by;
    while (!end_by || steady_clock::now() < *end_by) {
        if (const auto frame = frame_or_refusal(next, account)) {
            account.add(*frame);
            if (account.frames() == 1) {
                std::puts("frame");
                std::fflush(stdout);
            }
            if (end_by) {
                return account;
            }
        }
        if (!end_by && asked_to_end()) {
            end_by = steady_clock::now() + longest_wait;
        }
    }
    throw std::runtime_error("no frame for " + std::to_string(longest_wait.count()) + " s");
}

/// The answer of a read; a daemon that is gone is none of the things that this test allows.
bool got(ReadResult result, const std::string& why_gone) {
    if (result == ReadResult::gone) {
        throw std::logic_error("the daemon is gone: " + why_gone);
    }
    return result == ReadResult::frame;
}

constexpr std::chrono::milliseconds turn{200};  ///< then the standard input is looked at

ReaderAccount copy(disparity::SharedMemoryReader& reader) {
    Frame frame;
    return follow([&]() -> std::optional<SeenFrame> {
        if (!got(reader.read(frame, turn), reader.why_gone())) {
            return std::nullopt;
        }
        check_planes(frame);
        return seen(frame);
    });
}

ReaderAccount borrow(disparity::SharedMemoryReader& reader) {
    disparity::BorrowedFrame frame;
    return follow([&]() -> std::optional<SeenFrame> {
        if (!got(reader.borrow(frame, turn), reader.why_gone())) {
            return std::nullopt;
        }
        check_planes(frame);
        return seen(frame);
    });
}

/// All that the daemon makes.
std::vector<Product> products_of(const disparity::SocketClient& client) {
    v1::Welcome welcome;
    welcome.ParseFromString(client.welcome());
    std::vector<Product> products;
    for (const int product : welcome.products()) {
        products.push_back(static_cast<Product>(product));
    }
    return products;
}

disparity::Subscription subscription(const disparity::SocketClient& client, const std::string& manner) {
    disparity::Subscription wanted;
    wanted.products = {Product::disparity, Product::confidence, Product::left};
    if (manner == "raw") {
        wanted.products.push_back(Product::depth);
    } else if (manner == "everything") {
        wanted.products = products_of(client);
    } else if (manner == "zstd") {
        wanted.compressed = true;
    } else if (manner == "region") {
        wanted.region_x = wanted.region_y = 8;
        wanted.region_width = 64;
        wanted.region_height = 40;
        wanted.max_rate = 4;
    } else {
        throw std::invalid_argument("found manner \"" + manner +
                                    "\"; allowed: raw, everything, zstd, region; of shared memory: copy, borrow");
    }
    return wanted;
}

ReaderAccount over_socket(const std::string& address, const std::string& manner) {
    disparity::SocketClient client(address, "soak " + manner);
    client.subscribe(subscription(client, manner));
    Frame frame;
    return follow([&]() -> std::optional<SeenFrame> {
        if (!got(client.read(frame, turn), client.why_gone())) {
            return std::nullopt;
        }
        check_planes(frame);
        return seen(frame);
    });
}

ReaderAccount read_on(const std::string& address, const std::string& manner) {
    if (!address.starts_with("shm:")) {
        return over_socket(address, manner);
    }
    disparity::SharedMemoryReader reader(address.substr(4));
    return manner == "borrow" ? borrow(reader) : copy(reader);
}

}  // namespace
}  // namespace disparityd::test

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fputs("usage: soak_reader shm:NAME|tcp:HOST:PORT|unix:PATH MANNER\n", stderr);
        return 2;
    }
    try {
        std::printf("%s\n", disparityd::test::read_on(argv[1], argv[2]).to_json().c_str());
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "soak_reader: error: %s\n", error.what());
        return 1;
    }
}
