// SPDX-License-Identifier: Apache-2.0
//
// Says how fast a robot may drive straight ahead, and brakes when it does not know. See docs/howto/avoid-obstacles.md.
//   obstacle-avoidance-cpp [OPTION...] [NAME | tcp:HOST:PORT | tls:HOST:PORT | unix:PATH]
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>

#include <disparity_client.hpp>

#include "arguments.hpp"
#include "decision.hpp"

namespace {

using disparity::ReadResult;
using std::chrono::milliseconds;

// A read takes no longer, so that a signal is obeyed soon.
constexpr double longest_read_s = 0.2;
// The robot brakes while the program connects: to wait for it does no harm.
constexpr milliseconds connect_timeout{1000};

volatile std::sig_atomic_t stopped = 0;

void stop(int) {
    stopped = 1;
}

double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

disparity::Client connect(const std::string& where) {
    disparity::ClientOptions options;
    options.may_be_absent = true;  // the robot brakes until there is a daemon
    options.client_name = "obstacle-avoidance-cpp";
    options.timeout = connect_timeout;
    return disparity::connect(where, {.products = {disparity::Product::scan}}, options);
}

/// Returns a text between quotes, as JSON has it.
std::string quoted(const std::string& plain) {
    std::string out = "\"";
    for (const char c : plain) {
        if (c == '"' || c == '\\') {
            out += '\\';
        }
        out += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
    }
    return out + '"';
}

/// Prints decisions. This is the place where a robot's program commands its motors.
class Output {
public:
    explicit Output(bool json) : json_(json) {}

    /// Prints a line for a change, or for each decision in JSON. `sequence` is the frame's; negative: no frame came.
    void show(const avoid::Decision& decision, long long sequence = -1) {
        if (json_) {
            const std::string ahead = std::isfinite(decision.ahead_m) ? avoid::text("%.3f", decision.ahead_m) : "null";
            std::printf("{\"state\":\"%s\",\"speed_mps\":%.3f,\"ahead_m\":%s,\"sequence\":%s,\"reason\":%s}\n",
                        avoid::name_of(decision.state), decision.speed_mps, ahead.c_str(),
                        sequence < 0 ? "null" : std::to_string(sequence).c_str(), quoted(decision.reason).c_str());
        } else if (first_ || avoid::is_change(last_, decision)) {
            std::puts(avoid::line_of(decision).c_str());
        }
        if (std::fflush(stdout) != 0) {
            throw std::runtime_error("standard output cannot be written");
        }
        last_ = decision;
        first_ = false;
    }

private:
    bool json_;
    bool first_ = true;
    avoid::Decision last_;
};

/// Judges a frame that has just been read. Its age is what it is now, whatever it took on the way.
void judge(avoid::Decider& decider, const disparity::Frame& frame) {
    const double read_s = now_s();
    avoid::FrameFacts facts;
    facts.age_s = static_cast<double>(frame.age_ns) / 1e9;
    facts.flags = frame.flags;
    try {
        const auto scan = frame.scan();
        facts.scan = scan ? &*scan : nullptr;
        decider.see(facts, read_s);
    } catch (const std::runtime_error& error) {
        decider.fail(error.what());
    }
}

/// Waits for what comes next. Returns the sequence of the frame that came, or -1 where none did.
long long step(disparity::Client& client, avoid::Decider& decider, disparity::Frame& frame) {
    const double patience = std::min(decider.patience_s(now_s()), longest_read_s);
    try {
        switch (client.read(frame, milliseconds(std::lround(std::ceil(patience * 1000))))) {
            case ReadResult::frame: judge(decider, frame); return static_cast<long long>(frame.sequence);
            case ReadResult::timeout: decider.wait(now_s()); break;
            case ReadResult::gone: decider.gone(client.why_gone()); break;
        }
    } catch (const std::exception& error) {
        decider.fail(error.what());
    }
    return -1;
}

void run(const avoid::Arguments& arguments) {
    disparity::Client client = connect(arguments.source);
    avoid::Decider decider(arguments.options);
    Output output(arguments.json);
    disparity::Frame frame;
    output.show(decider.decision());  // brakes until frames say something else
    while (stopped == 0) {
        const long long sequence = step(client, decider, frame);
        output.show(decider.decision(), sequence);
    }
    output.show(decider.stop());
}

}  // namespace

int main(int argc, char** argv) {
    std::signal(SIGINT, stop);
    std::signal(SIGTERM, stop);
    try {
        const auto arguments = avoid::parse(argc, argv);
        if (!arguments) {
            std::fputs(avoid::help, stdout);
            return 0;
        }
        run(*arguments);
        return 0;
    } catch (const std::invalid_argument& error) {
        std::fprintf(stderr, "obstacle-avoidance-cpp: error: %s\n", error.what());
        return 2;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "obstacle-avoidance-cpp: error: %s\n", error.what());
        return 1;
    }
}
