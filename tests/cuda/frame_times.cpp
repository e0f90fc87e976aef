// SPDX-License-Identifier: Apache-2.0
#include "tests/cuda/frame_times.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <semaphore>
#include <thread>

#include "tests/kernels/support.h"

namespace disparityd::test {

namespace {

using std::chrono::steady_clock;

constexpr std::size_t frames_in_rotation = 4;
constexpr int warm_up = 3;

double milliseconds(steady_clock::duration time) {
    return std::chrono::duration<double, std::milli>(time).count();
}

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
}

/// A flat scene at disparity d as a YUYV frame.
Image<std::uint8_t> raw_frame(Random& random, int width, int height, int d) {
    const auto left = noise(random, width, height);
    const auto right = shifted(random, left, d);
    Image<std::uint8_t> raw(4 * width, height, 128);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            raw.at(2 * x, y) = left.at(x, y);
            raw.at(2 * (width + x), y) = right.at(x, y);
        }
    }
    return raw;
}

/// Every pixel between four of the source.
struct Maps {
    Maps(int width, int height) : xy(2 * width, height), fraction(width, height, 13 * 32 + 7) {
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                xy.at(2 * x, y) = static_cast<std::int16_t>(x);
                xy.at(2 * x + 1, y) = static_cast<std::int16_t>(y);
            }
        }
    }
    RectifyMap view() const { return {xy.plane(), fraction.plane()}; }

    Image<std::int16_t> xy;
    Image<std::uint16_t> fraction;
};

/// A matcher and the frames that go round.
class Ring {
public:
    Ring(std::string_view name, const Size& size, const MatchOptions& options)
        : maps_(size.width, size.height), matcher(backend(name).create({size.width, size.height, options})) {
        Random random(1);
        rectifier_ = {true, maps_.view(), maps_.view(), 0, 0};
        rectifier_.id = 1;
        const Image<std::uint8_t> nothing(size.width, size.height);
        for (std::size_t i = 0; i < frames_in_rotation; ++i) {
            raw_.push_back(raw_frame(random, size.width, size.height, 10 + static_cast<int>(i)));
            frames_.push_back(std::make_unique<Frame>(*matcher, nothing, nothing));
            frames_[i]->view.raw = {raw_[i].plane().data, PixelFormat::yuyv, size.width, size.height, 4 * size.width};
            frames_[i]->view.rectifier = &rectifier_;
        }
    }

    /// Adds the times of the stage's steps to `found`.
    void run(std::size_t stage, int round, Parallel& workers, std::vector<double>& found) {
        std::vector<std::chrono::nanoseconds> times(matcher->stages()[stage].steps.size());
        matcher->run(static_cast<int>(stage), frames_[static_cast<std::size_t>(round) % frames_in_rotation]->view,
                     workers, times);
        for (const std::chrono::nanoseconds time : times) {
            found.push_back(milliseconds(time));
        }
    }

private:
    Maps maps_;
    Rectifier rectifier_;
    std::vector<Image<std::uint8_t>> raw_;
    std::vector<std::unique_ptr<Frame>> frames_;

public:
    std::unique_ptr<Matcher> matcher;
};

}  // namespace

FrameTimes frame_times(std::string_view backend, const Size& size, const MatchOptions& options, int rounds,
                       Parallel& workers) {
    Ring ring(backend, size, options);
    const auto stages = ring.matcher->stages();
    FrameTimes result;
    for (const StageInfo& stage : stages) {
        result.steps.insert(result.steps.end(), stage.steps.begin(), stage.steps.end());
    }
    std::vector<std::vector<double>> steps(result.steps.size());
    std::vector<double> frame;
    std::vector<double> matched;
    for (int round = 0; round < rounds + warm_up; ++round) {
        std::vector<double> found;
        const auto begin = steady_clock::now();
        ring.run(0, round, workers, found);
        const auto rectified = steady_clock::now();
        for (std::size_t stage = 1; stage < stages.size(); ++stage) {
            ring.run(stage, round, workers, found);
        }
        const auto end = steady_clock::now();
        if (round >= warm_up) {
            frame.push_back(milliseconds(end - begin));
            matched.push_back(milliseconds(end - rectified));
            for (std::size_t i = 0; i < found.size(); ++i) {
                steps[i].push_back(found[i]);
            }
        }
    }
    for (const auto& step : steps) {
        result.step.push_back(median(step));
    }
    result.frame = median(frame);
    result.matched = median(matched);
    return result;
}

double two_in_flight(std::string_view backend, const Size& size, const MatchOptions& options, int rounds,
                     Parallel& workers) {
    Ring ring(backend, size, options);
    std::counting_semaphore<frames_in_rotation> free(frames_in_rotation - 1);
    std::counting_semaphore<frames_in_rotation> rectified(0);
    std::thread rectifies([&] {
        for (int round = 0; round < rounds + warm_up; ++round) {
            std::vector<double> times;
            free.acquire();
            ring.run(0, round, workers, times);
            rectified.release();
        }
    });
    std::vector<double> between;
    auto before = steady_clock::now();
    for (int round = 0; round < rounds + warm_up; ++round) {
        std::vector<double> times;
        rectified.acquire();
        ring.run(1, round, workers, times);
        free.release();
        const auto now = steady_clock::now();
        if (round >= warm_up) {
            between.push_back(milliseconds(now - before));
        }
        before = now;
    }
    rectifies.join();
    return median(between);
}

}  // namespace disparityd::test
