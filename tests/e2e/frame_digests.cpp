// SPDX-License-Identifier: Apache-2.0
//
// frame_digests ADDRESS COUNT: prints what the C++ client reads, one line per frame; ADDRESS is "shm:NAME", "tcp:..."
// or "unix:...". A line is the publish index and then, for each product in order of its number, product:digest, and the
// metadata that must be the same for everybody.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "clients/cpp/disparity_client.hpp"

namespace {

using disparity::Frame;
using disparity::Product;
using disparity::ReadResult;

const std::vector<Product> products{Product::disparity, Product::confidence, Product::depth, Product::left};

std::uint64_t digest(const std::vector<std::uint8_t>& bytes) {
    std::uint64_t hash = 0xcbf29ce484222325ULL;
    for (const std::uint8_t byte : bytes) {
        hash = (hash ^ byte) * 0x100000001b3ULL;
    }
    return hash;
}

void print(Frame& frame) {
    std::printf("%llu", static_cast<unsigned long long>(frame.publish_index));
    std::sort(frame.planes.begin(), frame.planes.end(),
              [](const auto& a, const auto& b) { return a.product < b.product; });
    for (const auto& plane : frame.planes) {
        std::printf(" %u:%016llx", static_cast<unsigned>(plane.product),
                    static_cast<unsigned long long>(digest(plane.bytes)));
    }
    std::printf(" seq=%llu mono=%lld real=%lld cal=%016llx size=%ux%u d=%d+%u inv=%d flags=%u\n",
                static_cast<unsigned long long>(frame.sequence), static_cast<long long>(frame.monotonic_ns),
                static_cast<long long>(frame.realtime_ns), static_cast<unsigned long long>(frame.calibration_id),
                frame.width, frame.height, frame.d_min, frame.disparities, frame.invalid, frame.flags);
    std::fflush(stdout);
}

template <typename Client>
int follow(Client& client, int count) {
    Frame frame;
    while (count > 0) {
        switch (client.read(frame, std::chrono::seconds(60))) {
            case ReadResult::frame:
                print(frame);
                --count;
                break;
            case ReadResult::timeout: std::fputs("frame_digests: no frame in 60 s\n", stderr); return 1;
            case ReadResult::gone: std::fputs("frame_digests: the daemon is gone\n", stderr); return 1;
        }
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fputs("usage: frame_digests ADDRESS COUNT\n", stderr);
        return 2;
    }
    const std::string address = argv[1];
    try {
        if (address.starts_with("shm:")) {
            disparity::SharedMemoryReader reader(address.substr(4));
            return follow(reader, std::atoi(argv[2]));
        }
        disparity::SocketClient client(address);
        disparity::Subscription subscription;
        subscription.products = products;
        client.subscribe(subscription);
        return follow(client, std::atoi(argv[2]));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "frame_digests: error: %s\n", error.what());
        return 1;
    }
}
