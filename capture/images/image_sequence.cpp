// SPDX-License-Identifier: Apache-2.0
#include "capture/images/image_sequence.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "base/failure_text.h"
#include "base/file_kind.h"
#include "base/number_text.h"
#include "base/text_file.h"
#include "base/words.h"
#include "capture/images/euroc_folder.h"
#include "capture/images/folder_pair.h"
#include "capture/images/image_files.h"
#include "capture/images/image_times.h"
#include "capture/two_eyes.h"

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
        throw std::invalid_argument(folder + ": cannot be listed: " + base::error_text(error.value()));
    }
    std::sort(names.begin(), names.end());
    return names;
}

/// The parts of "left_%04d.png".
struct Pattern {
    std::string folder;
    std::string prefix;
    std::string suffix;
    std::size_t digits = 1;  ///< at least so many, padded with zeros

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
        const bool number = text.size() <= 19 &&
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
        if (end < text.size() && text[end] == 'd' && zeros && digits <= 19) {
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

bool is_image_name(std::string_view name) {
    const std::string ending = base::lower_case(fs::path(name).extension().string());
    return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

/// Splits the names of two images at a comma. Names may have commas, too: files that are there are preferred.
std::optional<ImageSequence::Frame> pair_of(const std::string& uri) {
    std::optional<ImageSequence::Frame> found;
    for (std::size_t comma = uri.find(','); comma != std::string::npos; comma = uri.find(',', comma + 1)) {
        ImageSequence::Frame pair{uri.substr(0, comma), uri.substr(comma + 1), 0, {}};
        if (is_image_name(pair.left) && is_image_name(pair.right)) {
            if (base::is_file(pair.left) && base::is_file(pair.right)) {
                return pair;
            }
            found = found ? found : pair;
        }
    }
    return found;
}

ImageSequence sequence_of(ImageSequence::Frame pair) {
    for (const std::string& path : {pair.left, pair.right}) {
        if (!base::is_file(path)) {
            throw std::invalid_argument(path + ": no such file");
        }
    }
    check_two_eyes(pair.left, pair.right);
    ImageSequence sequence;
    sequence.description = "image pair";
    sequence.frames.push_back(std::move(pair));
    return sequence;
}

/// Splits two patterns at a comma; nothing where it is one. Names of folders may have commas, too: folders that are
/// there are preferred.
std::optional<std::pair<std::string, std::string>> pair_of_patterns(const std::string& uri) {
    std::optional<std::pair<std::string, std::string>> found;
    for (std::size_t comma = uri.find(','); comma != std::string::npos; comma = uri.find(',', comma + 1)) {
        std::pair<std::string, std::string> pair{uri.substr(0, comma), uri.substr(comma + 1)};
        const auto is_pattern = [](const std::string& text) {
            return find_placeholder(fs::path(text).filename().string()).has_value();
        };
        const auto is_there = [](const std::string& text) {
            const fs::path folder = fs::path(text).parent_path();
            return folder.empty() || base::is_folder(folder);
        };
        if (is_pattern(pair.first) && is_pattern(pair.second)) {
            if (is_there(pair.first) && is_there(pair.second)) {
                return pair;
            }
            found = found ? found : pair;
        }
    }
    return found;
}

ImageSequence find_by_pattern(const std::string& uri) {
    const auto pair = pair_of_patterns(uri);
    const Pattern left = parse_pattern(pair ? pair->first : uri);
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
    sequence.description = pair ? "image pairs" : "side-by-side images";
    const std::optional<Pattern> right = pair ? std::optional(parse_pattern(pair->second)) : std::nullopt;
    for (const std::uint64_t number : numbers) {
        ImageSequence::Frame frame{left.file(number), right ? right->file(number) : std::string(), 0, {}};
        if (right && !base::is_file(frame.right)) {
            throw std::invalid_argument(frame.left + ": has no right image, looked for " + frame.right);
        }
        check_two_eyes(frame.left, frame.right);
        sequence.frames.push_back(std::move(frame));
    }
    take_times_of_names(sequence);
    return sequence;
}

std::string first_existing(std::initializer_list<fs::path> candidates) {
    for (const fs::path& candidate : candidates) {
        if (base::is_file(candidate)) {
            return candidate.string();
        }
    }
    return {};
}

/// The same as find_image() of a folder that holds the images of these names, without a look at it for each.
std::string find_among(const std::vector<std::string>& names, const std::string& folder, const std::string& stem) {
    for (const std::string_view ending : endings) {
        const std::string name = stem + std::string(ending);
        if (std::binary_search(names.begin(), names.end(), name) && base::is_file(fs::path(folder) / name)) {
            return (fs::path(folder) / name).string();
        }
    }
    // Cameras write endings, and people names, in capitals.
    for (const std::string& name : names) {
        if (base::lower_case(fs::path(name).stem().string()) == base::lower_case(stem)) {
            return (fs::path(folder) / name).string();
        }
    }
    return {};
}

std::optional<ImageSequence> find_middlebury(const std::string& folder) {
    // Scenes of nine views have their ground truth for views 2 and 6 (2001, 2003) or 1 and 5 (2005, 2006).
    constexpr std::array<std::pair<const char*, const char*>, 6> pairs{
        {{"left", "right"}, {"im2", "im6"}, {"im0", "im1"}, {"view1", "view5"}, {"view0", "view1"}, {"imL", "imR"}}};
    const std::vector<std::string> names = base::is_folder(folder) ? image_names(folder) : std::vector<std::string>();
    for (const auto& [left, right] : pairs) {
        ImageSequence::Frame frame{find_among(names, folder, left), find_among(names, folder, right), 0, {}};
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

/// KITTI 2012 and 2015 have a calibration for each scene: calib/000012.txt, calib_cam_to_cam/000012.txt, both for
/// 000012_10.png and 000012_11.png.
void find_calibrations_of_frames(const fs::path& root, ImageSequence& sequence) {
    for (ImageSequence::Frame& frame : sequence.frames) {
        const std::string stem = fs::path(frame.left).stem().string();
        const std::string name = stem.substr(0, stem.find('_')) + ".txt";
        frame.calibration = first_existing({root / "calib_cam_to_cam" / name, root / "calib" / name});
    }
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
        ImageSequence::Frame frame{
            (fs::path(folders.left) / name).string(), (fs::path(folders.right) / name).string(), 0, {}};
        if (!base::is_file(frame.right)) {
            throw std::invalid_argument(frame.left + ": has no right image, looked for " + frame.right);
        }
        sequence.frames.push_back(std::move(frame));
    }
    if (sequence.frames.empty()) {
        throw std::invalid_argument(folders.left + ": holds no images");
    }
    sequence.unpaired = unpaired_images(folders.right, sequence.frames.size());
    const fs::path root(folder);
    sequence.calibration =
        first_existing({root / "calib.txt", root / "calib_cam_to_cam.txt",
                        fs::absolute(root).lexically_normal().parent_path() / "calib_cam_to_cam.txt"});
    if (sequence.calibration.empty()) {
        find_calibrations_of_frames(root, sequence);
    }
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

/// Returns what stands in front of the parameters. Names may have question marks, too.
std::string path_of(const std::string& uri) {
    std::size_t end = uri.size();
    for (const char* key : {"?bits=", "?imu="}) {
        end = std::min(end, uri.rfind(key));
    }
    return uri.substr(0, end);
}

}  // namespace

ImageUri parse_image_uri(const std::string& uri) {
    ImageUri images{path_of(uri)};
    const auto refuse = [&](const std::string& what) { throw std::invalid_argument("source " + uri + ": " + what); };
    for (const std::string_view parameter : base::split(std::string_view(uri).substr(images.path.size()), '&')) {
        if (parameter.empty()) {
            continue;
        }
        const std::string_view text = parameter.substr(parameter.front() == '?' ? 1 : 0);
        const std::string_view key = text.substr(0, text.find('='));
        const std::string value(text.substr(std::min(key.size() + 1, text.size())));
        if (key == "bits") {
            constexpr int least = 9, most = 16;
            const auto bits = base::parse_number(value);
            if (!bits || *bits < least || *bits > most || *bits != static_cast<int>(*bits)) {
                refuse("bits: found '" + value + "', allowed is 9 to 16: how many bits of each value are used");
            }
            images.bits = static_cast<int>(*bits);
        } else if (key == "imu") {
            if (value != "off") {
                refuse("imu: found '" + value + "', allowed is off: the inertial sensor is left out");
            }
            images.inertial = false;
        } else {
            refuse("found '" + std::string(text) + "', allowed are bits=9 to 16 and imu=off");
        }
    }
    return images;
}

bool is_image_sequence(const std::string& uri) {
    const std::string path = path_of(uri);
    // A video's name may look like a pattern.
    const bool pattern = find_placeholder(path).has_value() && (is_image_name(path) || !base::is_file(path));
    return base::is_folder(path) || pattern || pair_of_folders(path).has_value() || pair_of(path).has_value() ||
           (is_image_name(path) && base::is_file(path));
}

std::string find_image(const std::string& folder, const std::string& stem) {
    for (const std::string_view ending : endings) {
        const fs::path path = fs::path(folder) / (stem + std::string(ending));
        if (base::is_file(path)) {
            return path.string();
        }
    }
    return base::is_folder(folder) ? find_among(image_names(folder), folder, stem) : std::string();
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
        if (base::is_folder(left) && base::is_folder(right)) {
            if (base::is_folder(left / "data") && base::is_folder(right / "data")) {
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
    // Hidden files are no images: systems put their own there, such as "._1.png".
    std::erase_if(names, [](const std::string& name) { return !is_image_name(name) || name.starts_with('.'); });
    return names;
}

ImageSequence find_images(const std::string& uri) {
    if (!base::is_folder(uri)) {
        if (const auto folders = pair_of_folders(uri)) {
            return pair_images(folders->first, folders->second);
        }
        const bool pattern = find_placeholder(uri).has_value();
        if (auto pair = pattern ? std::nullopt : pair_of(uri)) {
            return sequence_of(*std::move(pair));
        }
        if (!pattern && base::is_file(uri)) {
            throw std::invalid_argument(uri +
                                        ": is one image; name the right one too, as left.png,right.png; images that "
                                        "hold both eyes side by side as a pattern: both_%04d.png");
        }
        return find_by_pattern(uri);
    }
    if (auto found = find_kitti(uri)) {
        return *std::move(found);
    }
    if (auto found = find_middlebury(uri)) {
        return *std::move(found);
    }
    if (auto found = find_euroc(uri)) {
        return *std::move(found);
    }
    if (const auto folders = find_folders_of_eyes(uri)) {
        return pair_images(folders->first, folders->second);
    }
    throw std::invalid_argument(
        uri +
        ": holds no stereo images that are known: neither a pair (left/right, im0/im1, "
        "im2/im6, view1/view5 with .png, .ppm ...) nor folders of each eye (image_2 and "
        "image_3, image_0 and image_1, left and right, cam0/data and cam1/data ...); other names "
        "as two folders, FOLDER,FOLDER, or as a pattern: left_%04d.png,right_%04d.png");
}

std::vector<RunOfOneGeometry> runs_of_one_geometry(const std::string& uri, bool by_calibration) {
    const ImageSequence sequence = find_images(parse_image_uri(uri).path);
    std::vector<RunOfOneGeometry> runs;
    std::optional<ImageSize> size_before;
    std::string calibration_before;
    for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
        const ImageSequence::Frame& frame = sequence.frames[i];
        const auto size = peek_image_size(frame.left);
        std::string calibration;
        if (by_calibration && !frame.calibration.empty()) {
            calibration = base::read_text_file(frame.calibration, "calibration");
        }
        if (runs.empty() || (size && size_before && *size != *size_before) || calibration != calibration_before) {
            runs.push_back({i, 0});
        }
        ++runs.back().count;
        size_before = size ? size : size_before;
        calibration_before = std::move(calibration);
    }
    return runs;
}

}  // namespace disparityd::capture
