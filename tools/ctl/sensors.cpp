// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "tools/ctl/commands.h"
#include "tools/ctl/daemon_address.h"
#include "tools/ctl/describe.h"
#include "tools/ctl/interrupt.h"
#include "tools/ctl/number_argument.h"
#include "tools/ctl/status_message.h"

namespace disparityd::tools {
namespace {

using std::chrono::steady_clock;

struct SensorArguments {
    DaemonAddress daemon;
    std::optional<int> lines;
    bool json = false;
};

Json to_json(const disparity::SensorVector& vector) {
    return {vector.x, vector.y, vector.z};
}

Json to_json(const disparity::SensorSample& sample, std::uint64_t missed) {
    Json json{{"monotonic_ns", sample.monotonic_ns},
              {"realtime_ns", sample.realtime_ns},
              {"camera_ns", sample.camera_ns},
              {"missed", missed + sample.lost_before},
              {"frame_sync", sample.frame_sync}};
    if (sample.inertial) {
        json["angular_velocity"] = to_json(sample.inertial->angular_velocity);
        json["acceleration"] = to_json(sample.inertial->acceleration);
        json["imu_celsius"] = sample.inertial->celsius;
    }
    if (sample.magnetic_field) {
        json["magnetic_field"] = to_json(*sample.magnetic_field);
    }
    if (sample.environment) {
        json["celsius"] = sample.environment->celsius;
        json["hectopascal"] = sample.environment->hectopascal;
        json["humidity_percent"] = sample.environment->humidity_percent;
    }
    if (sample.eye_temperatures) {
        json["left_celsius"] = sample.eye_temperatures->left_celsius;
        json["right_celsius"] = sample.eye_temperatures->right_celsius;
    }
    return json;
}

/// What has come in a second, and the newest value of each kind.
struct Second {
    std::uint64_t samples = 0;
    std::uint64_t missed = 0;
    disparity::SensorSample newest;

    void add(const disparity::SensorBatch& batch) {
        samples += batch.samples.size();
        missed += batch.skipped;
        for (const disparity::SensorSample& sample : batch.samples) {
            missed += sample.lost_before;
            const auto keep = [](const auto& from, auto& to) { to = from ? from : to; };
            keep(sample.inertial, newest.inertial);
            keep(sample.magnetic_field, newest.magnetic_field);
            keep(sample.environment, newest.environment);
            keep(sample.eye_temperatures, newest.eye_temperatures);
        }
    }
};

std::string vector_text(const disparity::SensorVector& vector) {
    char text[64];
    std::snprintf(text, sizeof text, "%8.3f %8.3f %8.3f", static_cast<double>(vector.x), static_cast<double>(vector.y),
                  static_cast<double>(vector.z));
    return text;
}

void print_second(const Second& second, double seconds, double since_start) {
    if (second.samples == 0) {
        std::printf("%5.0f s          -  no sample: see disparityctl status\n", since_start);
        return;
    }
    const disparity::Inertial inertial = second.newest.inertial.value_or(disparity::Inertial{});
    std::printf("%5.0f s %10.1f  %s  %s %7.1f %7llu", since_start, static_cast<double>(second.samples) / seconds,
                vector_text(inertial.angular_velocity).c_str(), vector_text(inertial.acceleration).c_str(),
                static_cast<double>(inertial.celsius), static_cast<unsigned long long>(second.missed));
    if (const auto& field = second.newest.magnetic_field) {
        std::printf("  field %s uT", vector_text(*field).c_str());
    }
    if (const auto& air = second.newest.environment) {
        std::printf("  %.1f C, %.2f hPa, %.0f %%", static_cast<double>(air->celsius),
                    static_cast<double>(air->hectopascal), static_cast<double>(air->humidity_percent));
    }
    if (const auto& eyes = second.newest.eye_temperatures) {
        std::printf("  eyes %.1f, %.1f C", static_cast<double>(eyes->left_celsius),
                    static_cast<double>(eyes->right_celsius));
    }
    std::printf("\n");
}

/// A batch if one comes soon enough for Ctrl-C to be felt as immediate.
disparity::SensorBatch next_batch(disparity::SocketClient& client, steady_clock::time_point deadline) {
    constexpr std::chrono::milliseconds patience{100};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - steady_clock::now());
    disparity::SensorBatch batch;
    switch (client.read_sensors(batch, std::clamp(left, std::chrono::milliseconds(0), patience))) {
        case disparity::ReadResult::frame: break;
        case disparity::ReadResult::timeout: batch = {}; break;
        case disparity::ReadResult::gone: throw std::runtime_error("the daemon has stopped");
    }
    return batch;
}

void show_samples(disparity::SocketClient& client, std::optional<int> most) {
    for (int lines = 0; !interrupted();) {
        const disparity::SensorBatch batch = next_batch(client, steady_clock::now() + std::chrono::seconds(1));
        for (std::size_t i = 0; i < batch.samples.size(); ++i, ++lines) {
            if (most && lines >= *most) {
                return;
            }
            std::cout << to_text(to_json(batch.samples[i], i == 0 ? batch.skipped : 0), -1) << '\n';
        }
        std::cout.flush();
    }
}

void show_seconds(disparity::SocketClient& client, std::optional<int> most) {
    std::printf("   time  samples/s     turning, rad/s: x y z            acceleration, m/s2: x y z  IMU, C  missed\n");
    Second second;
    const auto start = steady_clock::now();
    auto last = start;
    for (int lines = 0; (!most || lines < *most) && !interrupted();) {
        second.add(next_batch(client, last + std::chrono::seconds(1)));
        const auto now = steady_clock::now();
        if (now >= last + std::chrono::seconds(1)) {
            print_second(second, std::chrono::duration<double>(now - last).count(),
                         std::chrono::duration<double>(now - start).count());
            std::fflush(stdout);
            second = {};
            last = now;
            ++lines;
        }
    }
}

int sensors(const SensorArguments& arguments) {
    disparity::SocketClient client = connect(arguments.daemon);
    disparity::Subscription subscription;
    subscription.products.clear();
    subscription.sensors = true;
    client.subscribe(subscription);
    catch_interrupts();
    if (arguments.json) {
        show_samples(client, arguments.lines);
    } else {
        show_seconds(client, arguments.lines);
    }
    return exit_done;
}

}  // namespace

void add_sensors(CLI::App& program, Action& action) {
    CLI::App& command = *program.add_subcommand(
        "sensors", "Show what the sensors of a running daemon's camera measure: motion, temperature, air.");
    const auto arguments = std::make_shared<SensorArguments>();
    arguments->daemon.add_to(command);
    add_integer(command, "--count", arguments->lines, 1, 1'000'000'000,
                "stop after this many lines; default: Ctrl-C stops");
    command.add_flag("--json", arguments->json, "every sample, one JSON object per line");
    command.footer(
        "Without --json: one line per second with the newest values. Live cameras that have sensors (ZED Mini, ZED 2,\n"
        "ZED 2i) and recordings of them; the values are those of the sensors, along their axes, nothing is "
        "calibrated.\n"
        "missed: samples lost by the daemon or here. Ctrl-C ends it, exit status 0.\n"
        "Examples: disparityctl sensors --count 10\n"
        "          disparityctl sensors --json | jq -c '[.monotonic_ns, .acceleration]'");
    command.callback([arguments, &action] { action = [arguments] { return sensors(*arguments); }; });
}

}  // namespace disparityd::tools
