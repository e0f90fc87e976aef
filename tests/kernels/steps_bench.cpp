// SPDX-License-Identifier: Apache-2.0
//
// Time of every step before and after matching, per instruction set, beside the reference and beside OpenCV's remap.
//   kernels_steps_bench [WIDTHxHEIGHT...]   (default 640x480 1280x720)
// Nanoseconds per pixel of one image in one thread's processor time: the least of rounds in which all take turns.
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <map>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "kernels/cpu/backend.h"
#include "kernels/cpu/step_kernels.h"
#include "kernels/frame_scratch.h"
#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

constexpr int rounds = 31;

double thread_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

// One line of the table: the same work done by several.
class Line {
public:
    explicit Line(std::string name) : name_(std::move(name)) {}
    // `prepare` is not timed.
    void add(std::string who, std::function<void()> work, std::function<void()> prepare = {}) {
        entries_.push_back({std::move(who), std::move(work), std::move(prepare), {}});
    }
    void run(double pixels) {
        for (int round = 0; round < rounds; ++round) {
            for (Entry& entry : entries_) {
                if (entry.prepare) {
                    entry.prepare();
                }
                const double start = thread_seconds();
                entry.work();
                entry.times.push_back(thread_seconds() - start);
            }
        }
        std::printf("%-24s", name_.c_str());
        for (Entry& entry : entries_) {
            std::sort(entry.times.begin(), entry.times.end());
            std::printf("  %s %.3f", entry.who.c_str(), 1e9 * entry.times[0] / pixels);
        }
        std::printf("\n");
        std::fflush(stdout);
    }

private:
    struct Entry {
        std::string who;
        std::function<void()> work;
        std::function<void()> prepare;
        std::vector<double> times;
    };
    std::string name_;
    std::vector<Entry> entries_;
};

struct Table {
    std::string name;
    const KernelSteps* steps;
};

std::vector<Table> tables() {
    std::vector<Table> all = {{"reference", &reference::steps}};
    for (const cpu::InstructionSet& set : cpu::instruction_sets()) {
        all.push_back({set.name, &cpu::steps(set.target)});
    }
    return all;
}

// The map of a wide-angle camera (f = 0.52 widths, k1 = -0.17), turned a little, from a picture `scale` times as wide.
struct CameraMap {
    CameraMap(int width, int height, double scale) : xy(height, width, CV_16SC2), fraction(height, width, CV_16UC1) {
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const double dx = (x - width / 2.0) / width;
                const double dy = (y - height / 2.0) / width;
                const double bend = 0.98 - 0.17 * (dx * dx + dy * dy) / (0.52 * 0.52);
                const double sx = scale * (width / 2.0 + width * bend * (dx - 0.012 * dy));
                const double sy = scale * (height / 2.0 + width * bend * (dy + 0.012 * dx));
                const int fx = static_cast<int>(std::lround(sx * 32));
                const int fy = static_cast<int>(std::lround(sy * 32));
                xy.at<cv::Vec2s>(y, x) = {static_cast<short>(fx >> 5), static_cast<short>(fy >> 5)};
                fraction.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>((fy & 31) * 32 + (fx & 31));
            }
        }
    }
    RectifyMap view() const {
        return {{xy.ptr<std::int16_t>(), 2 * xy.cols, xy.rows, 2 * xy.cols},
                {fraction.ptr<std::uint16_t>(), xy.cols, xy.rows, xy.cols}};
    }
    cv::Mat xy, fraction;
};

// Reads so much that nothing else is left in the caches.
void empty_caches() {
    static std::vector<std::uint64_t> memory((64 << 20) / sizeof(std::uint64_t), 1);
    for (std::uint64_t& word : memory) {
        ++word;
    }
}

void bench_rectify(int width, int height, double scale, PixelFormat format, const char* name,
                   const std::function<void()>& prepare = {}) {
    Random random(1);
    const int eye_width = static_cast<int>(width * scale) / 2 * 2;
    const int source_height = static_cast<int>(height * scale);
    Image<std::uint8_t> bytes = noise(random, 2 * eye_width * bytes_per_pixel(format), source_height);
    const RawImage raw{bytes.plane().data, format, eye_width, source_height, bytes.width()};
    const CameraMap map(width, height, scale);
    const Rectifier rectifier{true, map.view(), map.view()};
    Image<std::uint8_t> out(width, height);
    cv::Mat grey, expected;
    const cv::Mat eye(source_height, eye_width, CV_8UC(bytes_per_pixel(format)), bytes.plane().data,
                      static_cast<std::size_t>(bytes.width()));
    cv::setNumThreads(1);
    Line line(name);
    line.add(
        "opencv",
        [&] {
            if (format == PixelFormat::yuyv) {
                cv::extractChannel(eye, grey, 0);
            }
            cv::remap(format == PixelFormat::yuyv ? grey : eye, expected, map.xy, map.fraction, cv::INTER_LINEAR,
                      cv::BORDER_CONSTANT, 0);
        },
        prepare);
    for (const Table& table : tables()) {
        line.add(
            table.name, [&, table] { table.steps->rectify(raw, Eye::left, rectifier, out.plane(), out.rows()); },
            prepare);
    }
    line.run(1.0 * width * height);
    if (format != PixelFormat::yuyv || scale != 1 || prepare) {
        return;
    }
    Line colour("rectify_colour yuyv");
    Image<std::uint8_t> bgr(3 * width, height);
    cv::Mat converted;
    colour.add("opencv", [&] {
        cv::cvtColor(eye, converted, cv::COLOR_YUV2BGR_YUYV);
        cv::remap(converted, expected, map.xy, map.fraction, cv::INTER_LINEAR, cv::BORDER_CONSTANT, 0);
    });
    for (const Table& table : tables()) {
        colour.add(table.name, [&, table] { table.steps->rectify_colour(raw, rectifier, bgr.plane(), bgr.rows()); });
    }
    colour.run(1.0 * width * height);
}

// A textured scene of planes at several distances, matched, so that what comes after matching has real work.
struct Matched {
    Matched(int width, int height)
        : options(default_options(Method::sgm, {0, 64})),
          matcher(backend("cpu").create({width, height, options})),
          frame(make(*matcher, width, height)) {
        Serial serial;
        std::array<std::chrono::nanoseconds, 4> times{};
        const int stages = static_cast<int>(matcher->stages().size());
        for (int i = 1; i < stages - 1; ++i) {
            matcher->run(i, frame->view, serial, times);
        }
        const FrameScratch scratch(reference::steps, matcher->config());
        left_winner = scratch.left_winner(frame->view.scratch);
        right_winner = scratch.right_winner(frame->view.scratch);
        reject();
    }

    static std::unique_ptr<Frame> make(const Matcher& matcher, int width, int height) {
        Random random(2);
        Image<std::uint8_t> right = noise(random, width, height);
        cv::Mat texture(height, width, CV_8U, right.plane().data);
        cv::GaussianBlur(texture, texture, {0, 0}, 1.2);
        cv::normalize(texture, texture, 20, 230, cv::NORM_MINMAX);
        Image<std::uint8_t> left = right;
        for (int i = 0; i < 40; ++i) {
            const cv::Rect box(pick(random, 0, width - 1), pick(random, 0, height - 1), width / 8, height / 6);
            const cv::Rect inside = box & cv::Rect(0, 0, width, height);
            const int d = 2 + i;
            for (int y = inside.y; y < inside.y + inside.height; ++y) {
                for (int x = std::max(inside.x, d); x < inside.x + inside.width; ++x) {
                    left.at(x, y) = right.at(x - d, y);
                }
            }
        }
        for (std::uint8_t& pixel : left.pixels()) {
            pixel = static_cast<std::uint8_t>(std::clamp(pixel + pick(random, -4, 4), 0, 255));
        }
        return std::make_unique<Frame>(matcher, left, right);
    }

    // Planes as they are between the steps.
    void reject() {
        const Rows rows{0, frame->disparity.height()};
        before = frame->disparity;
        checked = before;
        reference::left_right(left_winner, right_winner, options.range, checked.plane(), rows);
        filtered = checked;
        reference::median(checked.plane(), invalid(), 3, filtered.plane(), rows);
        clean = filtered;
        std::vector<std::byte> scratch(reference::speckle_scratch(clean.width(), clean.height()));
        reference::speckle(clean.plane(), invalid(), 100, 16, scratch);
    }
    std::int16_t invalid() const { return invalid_disparity(options.range); }

    MatchOptions options;
    std::unique_ptr<Matcher> matcher;
    std::unique_ptr<Frame> frame;
    Plane<std::int16_t> left_winner, right_winner;
    Image<std::int16_t> before{1, 1}, checked{1, 1}, filtered{1, 1}, clean{1, 1};
};

int rejected(const Image<std::int16_t>& image, std::int16_t invalid) {
    return static_cast<int>(std::count(image.pixels().begin(), image.pixels().end(), invalid));
}

void bench_post(int width, int height) {
    Matched m(width, height);
    const double pixels = 1.0 * width * height;
    const Rows rows{0, height};
    Serial serial;
    Image<std::int16_t> work(width, height);
    Image<std::uint8_t> confidence(width, height, 200);
    Image<std::uint16_t> depth(width, height);
    std::printf("rejected: check %.1f %%, median %.1f %%, speckle %.1f %%\n",
                100 * rejected(m.checked, m.invalid()) / pixels, 100 * rejected(m.filtered, m.invalid()) / pixels,
                100 * rejected(m.clean, m.invalid()) / pixels);
    const auto start_with = [&](const Image<std::int16_t>& image) { return [&] { work.pixels() = image.pixels(); }; };
    Line left_right("left_right"), median("median 3x3"), median5("median 5x5"), speckle("speckle"),
        mask("mask_confidence"), interpolate("interpolate"), depths("depth");
    std::map<std::string, std::vector<std::byte>> scratch;
    for (const Table& table : tables()) {
        const KernelSteps* steps = table.steps;
        std::vector<std::byte>& memory = scratch[table.name];
        memory.resize(std::max(steps->speckle_scratch(width, height), steps->interpolate_scratch(width, height)));
        left_right.add(
            table.name,
            [&, steps] { steps->left_right(m.left_winner, m.right_winner, m.options.range, work.plane(), rows); },
            start_with(m.before));
        median.add(table.name, [&, steps] { steps->median(m.checked.plane(), m.invalid(), 3, work.plane(), rows); });
        median5.add(table.name, [&, steps] { steps->median(m.checked.plane(), m.invalid(), 5, work.plane(), rows); });
        speckle.add(
            table.name, [&, steps] { steps->speckle(work.plane(), m.invalid(), 100, 16, memory, serial); },
            start_with(m.filtered));
        mask.add(table.name,
                 [&, steps] { steps->mask_confidence(m.clean.plane(), m.invalid(), confidence.plane(), rows); });
        interpolate.add(
            table.name,
            [&, steps] { steps->interpolate(work.plane(), m.right_winner, m.options.range, memory, serial); },
            start_with(m.clean));
        depths.add(table.name, [&, steps] {
            steps->depth(m.clean.plane(), m.invalid(), {672000, 3}, depth.plane(), rows);
        });
    }
    for (Line* line : {&left_right, &median, &median5, &speckle, &mask, &interpolate, &depths}) {
        line->run(pixels);
    }
}

void bench(int width, int height) {
    std::printf("\n%dx%d, ns per pixel\n", width, height);
    bench_rectify(width, height, 1, PixelFormat::yuyv, "rectify yuyv");
    bench_rectify(width, height, 1, PixelFormat::yuyv, "rectify yuyv, cold", empty_caches);
    bench_rectify(width, height, 1, PixelFormat::grey8, "rectify grey");
    bench_rectify(width, height, 1.5, PixelFormat::yuyv, "rectify yuyv, from 1.5x");
    bench_rectify(width, height, 2.5, PixelFormat::yuyv, "rectify yuyv, from 2.5x");
    bench_post(width, height);
}

}  // namespace
}  // namespace disparityd::test

int main(int argc, char** argv) {
    std::vector<std::string> sizes(argv + 1, argv + argc);
    if (sizes.empty()) {
        sizes = {"640x480", "1280x720"};
    }
    for (const std::string& size : sizes) {
        int width = 0;
        int height = 0;
        if (std::sscanf(size.c_str(), "%dx%d", &width, &height) != 2 || width < 64 || height < 64) {
            std::fprintf(stderr, "kernels_steps_bench: error: size '%s': allowed is WIDTHxHEIGHT, 64 or more each\n",
                         size.c_str());
            return 2;
        }
        disparityd::test::bench(width, height);
    }
    return 0;
}
