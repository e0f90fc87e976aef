// SPDX-License-Identifier: Apache-2.0
#include "capture/image_sequence.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "capture/file_kind.h"
#include "capture/image_times.h"
#include "capture/words.h"

namespace disparityd::capture {

namespace fs = std::filesystem;

namespace {

constexpr std::array<std::string_view, 9> endings{".png", ".ppm", ".pgm",  ".jpg", ".jpeg",
                                                  ".bmp", ".tif", ".tiff", ".webp"};

std::vector<std::string> names_in(const std::string& folder) {
    std::error_code error;
    std::vector<std::string> names;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        names.push_back(entry->path().filename().string());
    }
    if (error) {
        throw std::invalid_argument(folder + ": cannot be listed: " + error.message());
    }
    std::sort(names.begin(), names.end());
    return names;
}

/// "left_%04d.png" taken apart.
struct Pattern {
    std::string folder;
    std::string prefix;
    std::string suffix;
    std::size_t digits = 1;  ///< at least as many, filled up with zeros

    std::string file(std::uint64_t number) const {
        std::string text = std::to_string(number);
        if (text.size() < digits) {
            text.insert(0, digits - text.size(), '0');
        }
        return (fs::path(folder) / (prefix + text + suffix)).string();
    }

    std::optional<std::uint64_t> number_of(const std::string& name) const {
        if (name.size() <= prefix.size() + suffix.size() || !name.starts_with(prefix) || !name.ends_with(suffix)) {
            return std::nullopt;
        }
        const std::string text = name.substr(prefix.size(), name.size() - prefix.size() - suffix.size());
        const bool number = text.size() <= 18 &&
                            std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
        if (!number || text.size() < digits || (text.size() > digits && text[0] == '0')) {
            return std::nullopt;
        }
        return std::stoull(text);
    }
};

struct Placeholder {
    std::size_t at = 0;
    std::size_t length = 0;
    std::size_t digits = 1;
};

std::optional<Placeholder> find_placeholder(const std::string& text) {
    for (std::size_t at = text.find('%'); at != std::string::npos; at = text.find('%', at + 1)) {
        std::size_t end = at + 1;
        std::size_t digits = 0;
        while (end < text.size() && std::isdigit(static_cast<unsigned char>(text[end])) != 0 && digits < 100) {
            digits = 10 * digits + static_cast<std::size_t>(text[end] - '0');
            ++end;
        }
        const bool zeros = end == at + 1 || text[at + 1] == '0';
        if (end < text.size() && text[end] == 'd' && zeros && digits <= 18) {
            return Placeholder{at, end + 1 - at, std::max<std::size_t>(digits, 1)};
        }
    }
    return std::nullopt;
}

Pattern parse_pattern(const std::string& uri) {
    const fs::path path(uri);
    const std::string name = path.filename().string();
    const std::optional<Placeholder> found = find_placeholder(name);
    if (!found || find_placeholder(name.substr(found->at + found->length))) {
        throw std::invalid_argument(uri + ": a pattern has one %d or %0Nd in the file's name, such as left_%04d.png");
    }
    const std::string folder = path.parent_path().string();
    return {folder.empty() ? "." : folder, name.substr(0, found->at), name.substr(found->at + found->length),
            found->digits};
}

ImageSequence find_by_pattern(const std::string& uri) {
    const std::size_t comma = uri.find(',');
    const Pattern left = parse_pattern(uri.substr(0, comma));
    std::vector<std::uint64_t> numbers;
    for (const std::string& name : names_in(left.folder)) {
        if (const auto number = left.number_of(name)) {
            numbers.push_back(*number);
        }
    }
    if (numbers.empty()) {
        throw std::invalid_argument(uri + ": no file fits, looked for " + left.file(0) + ", " + left.file(1) + " ...");
    }
    std::sort(numbers.begin(), numbers.end());
    ImageSequence sequence;
    sequence.description = comma == std::string::npos ? "side-by-side images" : "image pairs";
    const std::optional<Pattern> right =
        comma == std::string::npos ? std::nullopt : std::optional(parse_pattern(uri.substr(comma + 1)));
    for (const std::uint64_t number : numbers) {
        ImageSequence::Frame frame{left.file(number), right ? right->file(number) : std::string(), 0};
        if (right && !is_file(frame.right)) {
            throw std::invalid_argument(frame.left + ": has no right image, looked for " + frame.right);
        }
        sequence.frames.push_back(std::move(frame));
    }
    return sequence;
}

std::string first_existing(std::initializer_list<fs::path> candidates) {
    for (const fs::path& candidate : candidates) {
        if (is_file(candidate)) {
            return candidate.string();
        }
    }
    return {};
}

std::optional<ImageSequence> find_middlebury(const std::string& folder) {
    // Scenes of nine views have their ground truth for views 2 and 6 (2001, 2003) or 1 and 5 (2005, 2006).
    constexpr std::array<std::pair<const char*, const char*>, 5> pairs{
        {{"left", "right"}, {"im2", "im6"}, {"im0", "im1"}, {"view1", "view5"}, {"view0", "view1"}}};
    for (const auto& [left, right] : pairs) {
        ImageSequence::Frame frame{find_image(folder, left), find_image(folder, right), 0};
        if (!frame.left.empty() && !frame.right.empty()) {
            ImageSequence sequence;
            sequence.rectified = true;
            sequence.description = "rectified pair";
            sequence.calibration = first_existing({fs::path(folder) / "calib.txt"});
            sequence.frames.push_back(std::move(frame));
            return sequence;
        }
    }
    return std::nullopt;
}

std::optional<ImageSequence> find_kitti(const std::string& folder) {
    const KittiFolders folders = find_kitti_folders(folder);
    if (folders.left.empty()) {
        return std::nullopt;
    }
    ImageSequence sequence;
    sequence.rectified = true;
    sequence.description = "KITTI " + folders.name;
    sequence.kitti_camera = folders.left_camera;
    for (const std::string& name : image_names(folders.left)) {
        ImageSequence::Frame frame{(fs::path(folders.left) / name).string(), (fs::path(folders.right) / name).string(),
                                   0};
        if (!is_file(frame.right)) {
            throw std::invalid_argument(frame.left + ": has no right image, looked for " + frame.right);
        }
        sequence.frames.push_back(std::move(frame));
    }
    if (sequence.frames.empty()) {
        throw std::invalid_argument(folders.left + ": holds no images");
    }
    const fs::path root(folder);
    sequence.calibration =
        first_existing({root / "calib.txt", root / "calib_cam_to_cam.txt",
                        fs::absolute(root).lexically_normal().parent_path() / "calib_cam_to_cam.txt"});
    const std::string times = first_existing(
        {fs::path(folders.left).parent_path() / "timestamps.txt", root / "timestamps.txt", root / "times.txt"});
    if (!times.empty()) {
        const std::vector<std::int64_t> ns = read_image_times(times, sequence.frames.size());
        for (std::size_t i = 0; i < ns.size(); ++i) {
            sequence.frames[i].time_ns = ns[i];
        }
        sequence.timed = true;
    }
    return sequence;
}

}  // namespace

bool is_image_sequence(const std::string& uri) {
    return is_folder(uri) || find_placeholder(uri).has_value();
}

std::string find_image(const std::string& folder, const std::string& stem) {
    for (const std::string_view ending : endings) {
        const fs::path path = fs::path(folder) / (stem + std::string(ending));
        if (is_file(path)) {
            return path.string();
        }
    }
    return {};
}

KittiFolders find_kitti_folders(const std::string& folder) {
    struct Layout {
        const char* left;
        const char* right;
        int camera;
    };
    constexpr std::array<Layout, 5> layouts{{{"image_2", "image_3", 2},
                                             {"image_02", "image_03", 2},
                                             {"colored_0", "colored_1", 2},
                                             {"image_0", "image_1", 0},
                                             {"image_00", "image_01", 0}}};
    for (const Layout& layout : layouts) {
        fs::path left = fs::path(folder) / layout.left;
        fs::path right = fs::path(folder) / layout.right;
        if (is_folder(left) && is_folder(right)) {
            if (is_folder(left / "data") && is_folder(right / "data")) {
                left /= "data";
                right /= "data";
            }
            return {left.string(), right.string(), std::string(layout.left) + "/" + layout.right, layout.camera};
        }
    }
    return {};
}

std::vector<std::string> image_names(const std::string& folder) {
    std::vector<std::string> names = names_in(folder);
    std::erase_if(names, [](const std::string& name) {
        return std::find(endings.begin(), endings.end(), lower_case(fs::path(name).extension().string())) ==
               endings.end();
    });
    return names;
}

ImageSequence find_images(const std::string& uri) {
    if (!is_folder(uri)) {
        return find_by_pattern(uri);
    }
    if (auto found = find_kitti(uri)) {
        return *std::move(found);
    }
    if (auto found = find_middlebury(uri)) {
        return *std::move(found);
    }
    throw std::invalid_argument(uri +
                                ": holds no stereo images that are known: neither a pair (left/right, im0/im1, "
                                "im2/im6, view1/view5 with .png, .ppm ...) nor KITTI's folders (image_2 and image_3, "
                                "image_0 and image_1 ...); other names as a pattern: left_%04d.png,right_%04d.png");
}

}  // namespace disparityd::capture
