// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <chrono>
#include <cstring>
#include <iostream>
#include <set>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "proto/products.h"
#include "tools/command_line/number_argument.h"
#include "tools/ctl/colour_argument.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/frame_reader.h"
#include "tools/ctl/no_frame.h"
#include "tools/ctl/output_file.h"
#include "tools/images/disparity_file.h"
#include "tools/images/image_file.h"
#include "tools/images/picture.h"

namespace disparityd::tools {
namespace {

using disparity::Product;

static_assert(std::endian::native == std::endian::little, "planes arrive in little endian and are used as they are");

/// A frame that is older is not what a daemon sees now: a newer one is waited for.
constexpr std::chrono::seconds old_frame{1};

struct SnapshotArguments {
    DaemonAddress daemon;
    std::string picture;
    std::string disparity;
    std::string depth;
    std::string depth_error;
    std::string colours;
    std::optional<int> timeout_s;
};

const disparity::PlaneData& plane_of(const disparity::Frame& frame, Product product) {
    const disparity::PlaneData* plane = frame.plane(product);
    if (plane == nullptr) {
        const proto::ProductFacts& wanted = proto::product_facts(static_cast<v1::Product>(product));
        std::string why = "the daemon does not serve the product " + std::string(wanted.name);
        if (!wanted.key.empty()) {
            why += ": set " + std::string(wanted.key) + " = true in its configuration";
        }
        throw std::runtime_error(why);
    }
    return *plane;
}

/// The bytes as numbers, in memory that is aligned for them.
template <typename T>
std::vector<T> numbers(const disparity::PlaneData& plane) {
    std::vector<T> values(plane.bytes.size() / sizeof(T));
    std::memcpy(values.data(), plane.bytes.data(), values.size() * sizeof(T));
    return values;
}

template <typename T>
Plane<const T> view(const std::vector<T>& values, const disparity::PlaneData& plane) {
    const int width = static_cast<int>(plane.width);
    return {values.data(), width, static_cast<int>(plane.height), width};
}

cv::Mat left_picture(const disparity::Frame& frame) {
    if (const disparity::PlaneData* colour = frame.plane(Product::left_colour)) {
        const int row = static_cast<int>(colour->width) * 3;
        return images::colour_view({colour->bytes.data(), row, static_cast<int>(colour->height), row});
    }
    const disparity::PlaneData& left = plane_of(frame, Product::left);
    const int row = static_cast<int>(left.width);
    return images::grey_view({left.bytes.data(), row, static_cast<int>(left.height), row});
}

void write_disparity(const std::string& path, const images::DisparityMap& map) {
    if (images::has_ending(path, ".pfm")) {
        images::write_disparity_pfm(path, map);
        return;
    }
    if (!images::fits_png(map.range)) {
        throw std::invalid_argument(path +
                                    ": a 16-bit PNG holds disparities from 0 to 255.99 px, the daemon searches " +
                                    std::to_string(map.range.first) + " to " +
                                    std::to_string(map.range.first + map.range.count - 1) + "; name it .pfm");
    }
    images::write_disparity_png(path, map);
}

/// Writes depth or its errors, where there is a name for them.
void write_millimetres(const std::string& path, const disparity::Frame& frame, Product product) {
    if (!path.empty()) {
        const disparity::PlaneData& plane = plane_of(frame, product);
        const auto mm = numbers<std::uint16_t>(plane);
        images::write_depth_png(path, view(mm, plane));
        std::cout << path << '\n';
    }
}

disparity::Frame next_frame(const SnapshotArguments& arguments) {
    std::vector<Product> products{Product::disparity, Product::left};
    if (!arguments.depth.empty()) {
        products.push_back(Product::depth);
    }
    if (!arguments.depth_error.empty()) {
        products.push_back(Product::depth_error);
    }
    const int timeout_s = arguments.timeout_s.value_or(10);
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(timeout_s);
    const auto frames =
        open_frames(arguments.daemon, products,
                    std::min<std::chrono::milliseconds>(std::chrono::seconds(timeout_s), patience_to_connect));
    disparity::Frame frame;
    std::string last;
    while (true) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
        switch (frames->read(frame, std::max(left, std::chrono::milliseconds(0)))) {
            case disparity::ReadResult::frame: break;
            case disparity::ReadResult::timeout:
                throw std::runtime_error("no frame came within " + std::to_string(timeout_s) +
                                         " s: " + why_no_frame(arguments.daemon) + last);
            case disparity::ReadResult::gone: throw std::runtime_error("the daemon has stopped" + last);
        }
        // Shared memory still has the last frame of a source that has ended, or of a daemon that hangs.
        const std::chrono::nanoseconds age(frame.age_ns);
        if (age < old_frame) {
            break;
        }
        last = "; the newest frame is " + seconds_text(age) + " old";
        if (source_has_ended(arguments.daemon)) {
            std::cerr << "disparityctl: the source has ended: its last frame is written, which is " << seconds_text(age)
                      << " old\n";
            break;
        }
    }
    disparity::Frame newer;
    if (frames->read(newer, std::chrono::milliseconds(0)) == disparity::ReadResult::gone) {
        throw std::runtime_error("the daemon has stopped" + last);
    }
    return frame;
}

/// Refuses what could not be written before a frame is waited for.
void check_names(const SnapshotArguments& arguments) {
    if (arguments.picture.empty() && arguments.disparity.empty() && arguments.depth.empty() &&
        arguments.depth_error.empty()) {
        throw std::invalid_argument(
            "snapshot: nothing to write; give at least one of -o, --disparity, --depth, --depth-error");
    }
    if (!arguments.picture.empty()) {
        images::check_picture_name(arguments.picture);
    }
    if (!arguments.disparity.empty()) {
        images::check_ending(arguments.disparity, {".png", ".pfm"});
    }
    for (const std::string& path : {arguments.depth, arguments.depth_error}) {
        if (!path.empty()) {
            images::check_ending(path, {".png"});
        }
    }
    std::set<std::string> names;
    for (const std::string& path : {arguments.picture, arguments.disparity, arguments.depth, arguments.depth_error}) {
        if (path.empty()) {
            continue;
        }
        check_writable(path);
        if (!names.insert(path).second) {
            throw std::invalid_argument(path + ": named for two images, allowed: a file for each");
        }
    }
}

int snapshot(const SnapshotArguments& arguments) {
    check_names(arguments);
    const disparity::Frame frame = next_frame(arguments);
    const disparity::PlaneData& plane = plane_of(frame, Product::disparity);
    const auto d16 = numbers<std::int16_t>(plane);
    const images::DisparityMap map{view(d16, plane), {frame.d_min, static_cast<int>(frame.disparities)}};
    if (!arguments.picture.empty()) {
        const images::Metric metric{frame.f, frame.baseline_mm, frame.disparity_offset};
        const images::ColourScale scale = images::colour_scale(map, colour_range(arguments.colours));
        cv::Mat picture = images::picture(left_picture(frame), map, scale, metric);
        if ((frame.flags & disparity::synthetic) != 0) {
            images::mark_synthetic(picture);
        }
        images::write_picture(arguments.picture, picture);
        std::cout << arguments.picture << '\n';
    }
    if (!arguments.disparity.empty()) {
        write_disparity(arguments.disparity, map);
        std::cout << arguments.disparity << '\n';
    }
    write_millimetres(arguments.depth, frame, Product::depth);
    write_millimetres(arguments.depth_error, frame, Product::depth_error);
    return exit_done;
}

}  // namespace

void add_snapshot(CLI::App& program, Action& action) {
    CLI::App& command = *program.add_subcommand("snapshot", "Write the newest frame of a daemon as pictures.");
    const auto arguments = std::make_shared<SnapshotArguments>();
    CLI::Option* const picture =
        command
            .add_option("-o,--output", arguments->picture, "left image, coloured disparity and its scale (.png, .jpg)")
            ->type_name("FILE");
    command
        .add_option("--disparity", arguments->disparity,
                    "disparity as a 16-bit PNG (disparity x 256, 0 = rejected), or as PFM when FILE ends in .pfm")
        ->type_name("FILE");
    command.add_option("--depth", arguments->depth, "depth in mm as a 16-bit PNG (0 = unknown, 65535 = farther)")
        ->type_name("FILE");
    command
        .add_option("--depth-error", arguments->depth_error,
                    "one sigma of depth in mm as a 16-bit PNG (0 = unknown, 65535 = more)")
        ->type_name("FILE");
    add_integer(command, "--timeout", arguments->timeout_s, 1, 3600, "seconds to wait for a frame; default 10");
    add_colour_range(command, arguments->colours)->needs(picture);
    arguments->daemon.add_to(command);
    command.footer(
        "A frame older than a second is not written, but for the last one of a source that has ended, with its age\n"
        "on standard error.\n"
        "Example: disparityctl snapshot -o now.png --disparity now.pfm");
    command.callback([arguments, &action] { action = [arguments] { return snapshot(*arguments); }; });
}

}  // namespace disparityd::tools
