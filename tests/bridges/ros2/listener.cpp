// SPDX-License-Identifier: Apache-2.0
//
// Subscribes with Fast DDS and tells what came: how much, how late, and which frames are missing.
//   ros2_listener DOMAIN SECONDS [--best-effort] [--default-buffers] TOPIC TYPE ...
// TOPIC is that of DDS, such as rt/stereo/left/image_rect, TYPE such as sensor_msgs::msg::dds_::Image_. It prints a
// line when the first message of a topic comes, and at the end a line for each topic. Times are from the stamp, which
// is the capture, to the callback: both on this machine's clock. A gap of more than one and a half of the usual ones
// counts as lost frames, whoever lost them.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/bridges/ros2/fast_subscriber.h"

namespace {

using disparityd::test::FastMessage;
using disparityd::test::FastSubscriber;

struct Heard {
    std::string topic;
    std::string type;
    std::vector<std::int64_t> stamps;
    std::vector<double> late_ms;
    std::size_t bytes = 0;

    void add(const FastMessage& message) {
        if (message.bytes.size() < 12) {  // Fast DDS 2.9.1 hands out an empty one now and then where many are lost
            return;
        }
        if (stamps.empty()) {
            std::printf("first %s\n", topic.c_str());
            std::fflush(stdout);
        }
        stamps.push_back(stamp_of(message));
        late_ms.push_back(static_cast<double>(message.arrived_ns - stamps.back()) / 1e6);
        bytes = message.bytes.size();
    }

    void report() {
        if (stamps.size() < 3) {
            std::printf("%s: %zu messages\n", topic.c_str(), stamps.size());
            return;
        }
        std::sort(stamps.begin(), stamps.end());
        std::vector<std::int64_t> gaps;
        for (std::size_t i = 1; i < stamps.size(); ++i) {
            gaps.push_back(stamps[i] - stamps[i - 1]);
        }
        std::vector<std::int64_t> sorted = gaps;
        std::sort(sorted.begin(), sorted.end());
        const std::int64_t usual = std::max<std::int64_t>(sorted[sorted.size() / 2], 1);
        std::int64_t lost = 0;
        for (const std::int64_t gap : gaps) {
            lost += (gap + usual / 2) / usual - 1;
        }
        std::sort(late_ms.begin(), late_ms.end());
        std::printf("%s: %zu messages of %zu bytes, %lld lost, ms after capture p50 %.1f p99 %.1f max %.1f\n",
                    topic.c_str(), stamps.size(), bytes, static_cast<long long>(std::max<std::int64_t>(lost, 0)),
                    late_ms[late_ms.size() / 2], late_ms[late_ms.size() * 99 / 100], late_ms.back());
    }
};

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::string> arguments(argv + 1, argv + argc);
    const bool reliable = std::erase(arguments, "--best-effort") == 0;
    const bool own_buffers = std::erase(arguments, "--default-buffers") == 0;
    if (arguments.size() < 4 || arguments.size() % 2 != 0) {
        std::fprintf(stderr,
                     "usage: ros2_listener DOMAIN SECONDS [--best-effort] [--default-buffers] TOPIC TYPE ...\n");
        return 2;
    }
    FastSubscriber subscriber(static_cast<std::uint32_t>(std::stoul(arguments[0])), own_buffers);
    std::vector<Heard> topics;
    for (std::size_t i = 2; i < arguments.size(); i += 2) {
        topics.push_back({arguments[i], arguments[i + 1], {}, {}});
        subscriber.subscribe(arguments[i], arguments[i + 1], {.reliable = reliable});
    }
    subscriber.wait(
        [&] {
            for (Heard& heard : topics) {
                for (const FastMessage& message : subscriber.take(heard.topic)) {
                    heard.add(message);
                }
            }
            return false;
        },
        std::chrono::seconds(std::stol(arguments[1])));
    for (Heard& heard : topics) {
        heard.report();
    }
    return 0;
}
