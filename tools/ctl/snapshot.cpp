// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <chrono>
#include <cstring>
#include <iostream>
#include <map>
#include <set>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "proto/products.h"
#include "tools/command_line/number_argument.h"
#include "tools/ctl/colour_argument.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/daemon.h"
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
    DaemonArguments daemon;
    std::string picture;
    std::vector<std::string> values;  ///< "NAME=FILE"
    std::string disparity;
    std::string depth;
    std::string depth_error;
    std::string colours;
    std::optional<int> timeout_s;
};

const disparity::PlaneData& plane_of(const disparity::Frame& frame, Product product) {
    const disparity::PlaneData* plane = frame.plane(product);
    if (plane == nullptr) {
        throw std::runtime_error(proto::not_served_text(static_cast<v1::Product>(product)));
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

/// Returns bytes as a picture, grey or in colour, without a copy.
cv::Mat picture_of(const disparity::PlaneData& plane) {
    const int row = static_cast<int>(plane.width * plane.bytes_per_pixel);
    const Plane<const std::uint8_t> bytes{plane.bytes.data(), row, static_cast<int>(plane.height), row};
    return plane.bytes_per_pixel == 3 ? images::colour_view(bytes) : images::grey_view(bytes);
}

cv::Mat left_picture(const disparity::Frame& frame) {
    const disparity::PlaneData* const colour = frame.plane(Product::left_colour);
    return picture_of(colour != nullptr ? *colour : plane_of(frame, Product::left));
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

/// Writes the values of a product as they are.
void write_values(const std::string& path, const disparity::Frame& frame, Product product) {
    const disparity::PlaneData& plane = plane_of(frame, product);
    if (product == Product::disparity) {
        const auto d16 = numbers<std::int16_t>(plane);
        write_disparity(path, {view(d16, plane), {frame.d_min, static_cast<int>(frame.disparities)}});
    } else if (plane.bytes_per_pixel == 2) {
        const auto mm = numbers<std::uint16_t>(plane);
        images::write_depth_png(path, view(mm, plane));
    } else {
        images::write_picture(path, picture_of(plane));
    }
}

/// Returns the product of this name. Throws std::invalid_argument with one line for a name that is no image's.
Product image_named(std::string_view name) {
    std::string names;
    for (const proto::ProductFacts& product : proto::products) {
        if (product.channels == 0) {
            continue;
        }
        if (product.name == name) {
            return static_cast<Product>(product.number);
        }
        names += (names.empty() ? "" : ", ") + std::string(product.name);
    }
    throw std::invalid_argument("--values: found '" + std::string(name) + "', allowed: NAME=FILE with one of " + names);
}

/// Returns the files of values, each with its product.
std::map<Product, std::string> files_of(const SnapshotArguments& arguments) {
    std::map<Product, std::string> files;
    const auto add = [&files](Product product, const std::string& path) {
        if (!path.empty() && !files.emplace(product, path).second) {
            throw std::invalid_argument(path + ": a second file for the same image, allowed: one for each");
        }
    };
    add(Product::disparity, arguments.disparity);
    add(Product::depth, arguments.depth);
    add(Product::depth_error, arguments.depth_error);
    for (const std::string& value : arguments.values) {
        const std::size_t equals = value.find('=');
        const Product product = image_named(std::string_view(value).substr(0, equals));
        if (equals == std::string::npos || equals + 1 == value.size()) {
            throw std::invalid_argument("--values: found '" + value + "', allowed: NAME=FILE");
        }
        add(product, value.substr(equals + 1));
    }
    return files;
}

disparity::Frame next_of_daemon(const SnapshotArguments& arguments, const std::map<Product, std::string>& files) {
    std::vector<Product> products{Product::disparity, Product::left};
    for (const auto& [product, path] : files) {
        if (std::find(products.begin(), products.end(), product) == products.end()) {
            products.push_back(product);
        }
    }
    const int timeout_s = arguments.timeout_s.value_or(10);
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(timeout_s);
    disparity::Client client =
        connect(arguments.daemon, products,
                std::min<std::chrono::milliseconds>(std::chrono::seconds(timeout_s), patience_to_connect));
    disparity::Frame frame;
    std::string last;
    while (true) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
        switch (client.read(frame, std::max(left, std::chrono::milliseconds(0)))) {
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
    if (client.read(newer, std::chrono::milliseconds(0)) == disparity::ReadResult::gone) {
        throw std::runtime_error("the daemon has stopped" + last);
    }
    return frame;
}

/// Refuses what could not be written before a frame is waited for.
void check_names(const std::string& picture, const std::map<Product, std::string>& files) {
    if (picture.empty() && files.empty()) {
        throw std::invalid_argument(
            "snapshot: nothing to write; give at least one of -o, --disparity, --depth, --depth-error, --values");
    }
    std::set<std::string> names;
    const auto check = [&names](const std::string& path) {
        check_writable(path);
        if (!names.insert(path).second) {
            throw std::invalid_argument(path + ": named for two images, allowed: a file for each");
        }
    };
    if (!picture.empty()) {
        images::check_picture_name(picture);
        check(picture);
    }
    for (const auto& [product, path] : files) {
        if (product == Product::disparity) {
            images::check_ending(path, {".png", ".pfm"});
        } else {
            images::check_ending(path, {".png"});
        }
        check(path);
    }
}

void write_overview(const SnapshotArguments& arguments, const disparity::Frame& frame) {
    const disparity::PlaneData& plane = plane_of(frame, Product::disparity);
    const auto d16 = numbers<std::int16_t>(plane);
    const images::DisparityMap map{view(d16, plane), {frame.d_min, static_cast<int>(frame.disparities)}};
    const images::Metric metric{frame.f, frame.baseline_mm, frame.disparity_offset};
    const images::ColourScale scale = images::colour_scale(map, colour_range(arguments.colours));
    cv::Mat picture = images::picture(left_picture(frame), map, scale, metric);
    if ((frame.flags & disparity::synthetic) != 0) {
        images::mark_synthetic(picture);
    }
    images::write_picture(arguments.picture, picture);
}

int snapshot(const SnapshotArguments& arguments) {
    const std::map<Product, std::string> files = files_of(arguments);
    check_names(arguments.picture, files);
    const disparity::Frame frame = next_of_daemon(arguments, files);
    if (!arguments.picture.empty()) {
        write_overview(arguments, frame);
        std::cout << arguments.picture << '\n';
    }
    for (const auto& [product, path] : files) {
        write_values(path, frame, product);
        std::cout << path << '\n';
    }
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
    command
        .add_option("--values", arguments->values,
                    "the values of an image as they are, once for each: its name as a product, and a PNG, such as "
                    "left=left.png")
        ->type_name("NAME=FILE")
        ->allow_extra_args(false);
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
