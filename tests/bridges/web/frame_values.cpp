// SPDX-License-Identifier: Apache-2.0
//
// Prints each frame that the C++ client reads as a line of JSON, for foxglove_client.cjs: what comes with it, its scan,
// its planes as base64.
//   frame_values unix:PATH
#include <cstdio>
#include <exception>
#include <string>

#include "clients/cpp/disparity_client.hpp"
#include "clients/json/scan_json.h"

namespace {

using disparity::Product;
using disparityd::json::Json;

std::string base64(const std::vector<std::uint8_t>& bytes) {
    constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
        unsigned group = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            group = group << 8 | (k < count ? bytes[i + k] : 0U);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            text.push_back(k <= count ? digits[group >> (18 - 6 * k) & 63] : '=');
        }
    }
    return text;
}

const std::vector<std::pair<const char*, Product>> planes{{"disparity", Product::disparity},
                                                          {"confidence", Product::confidence},
                                                          {"depth", Product::depth},
                                                          {"left", Product::left},
                                                          {"depth_error", Product::depth_error}};

Json values_of(const disparity::Frame& frame) {
    Json json{{"realtime_ns", std::to_string(frame.realtime_ns)},  // JSON's numbers cannot hold 64 bits
              {"width", frame.width},
              {"height", frame.height},
              {"f", frame.f},
              {"cx", frame.cx},
              {"cy", frame.cy},
              {"baseline_mm", frame.baseline_mm},
              {"disparity_offset", frame.disparity_offset},
              {"d_min", frame.d_min},
              {"invalid", frame.invalid},
              {"scan", disparityd::json::to_json(frame.scan().value())},
              {"planes", Json::object()}};
    for (const auto& [name, product] : planes) {
        json["planes"][name] = base64(frame.plane(product)->bytes);
    }
    return json;
}

int run(const std::string& address) {
    disparity::SocketClient client(address, "frame_values");
    disparity::Subscription subscription;
    subscription.products = {Product::scan};
    for (const auto& [name, product] : planes) {
        subscription.products.push_back(product);
    }
    client.subscribe(subscription);
    disparity::Frame frame;
    while (client.read(frame, std::chrono::seconds(60)) == disparity::ReadResult::frame) {
        std::puts(values_of(frame).dump().c_str());
        std::fflush(stdout);
    }
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return argc == 2 ? run(argv[1]) : 2;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "frame_values: %s\n", error.what());
        return 1;
    }
}
