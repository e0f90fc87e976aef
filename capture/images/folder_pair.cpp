// SPDX-License-Identifier: Apache-2.0
#include "capture/images/folder_pair.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <vector>

#include "base/file_kind.h"
#include "base/words.h"
#include "capture/two_eyes.h"

namespace disparityd::capture {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view decimal_digits = "0123456789";

bool is_whole_number(std::string_view text) {
    return !text.empty() && text.find_first_not_of(decimal_digits) == std::string_view::npos;
}

std::int64_t value_of(std::string_view text) {
    std::int64_t value = 0;
    for (const char digit : text) {
        value = 10 * value + (digit - '0');
    }
    return value;
}

/// An image's name, taken apart: "left_0012.png" and "0012_left.png" have the number "0012", "1403636579.76.png" is one
/// alone.
struct ImageName {
    std::string file;
    std::string stem;
    std::string prefix;
    std::string number;

    explicit ImageName(const std::string& name) : file(name), stem(fs::path(name).stem().string()) {
        const std::size_t end = stem.find_last_of(decimal_digits) + 1;  // 0: there is none
        const std::size_t before = end == 0 ? std::string::npos : stem.find_last_not_of("0123456789.", end - 1);
        const std::size_t begin = stem.find_first_of(decimal_digits, before == std::string::npos ? 0 : before);
        prefix = stem.substr(0, begin);
        number = end == 0 ? std::string() : stem.substr(begin, end - begin);
    }
};

/// Whether the number of `a` is smaller, whatever zeros stand before it; the names where both are alike.
bool comes_before(const ImageName& a, const ImageName& b) {
    const auto whole = [](const ImageName& name) {
        const std::string_view text = std::string_view(name.number).substr(0, name.number.find('.'));
        return text.substr(std::min(text.find_first_not_of('0'), text.size()));
    };
    if (a.prefix != b.prefix || whole(a).size() == whole(b).size()) {
        return a.stem < b.stem;
    }
    return whole(a).size() < whole(b).size();
}

std::vector<ImageName> names_of(const std::string& folder) {
    std::vector<ImageName> names;
    for (const std::string& name : image_names(folder)) {
        names.emplace_back(name);
    }
    if (names.empty()) {
        throw std::invalid_argument(folder + ": holds no images");
    }
    std::sort(names.begin(), names.end(), comes_before);
    return names;
}

/// Returns the folder, or that within it which holds the images of EuRoC's cameras.
std::string folder_of_images(const fs::path& folder) {
    const fs::path data = folder / "data";
    return (base::is_folder(data) && image_names(folder.string()).empty() ? data : folder).string();
}

}  // namespace

std::optional<std::pair<std::string, std::string>> find_folders_of_eyes(const std::string& folder) {
    constexpr std::array<std::pair<const char*, const char*>, 7> known{{{"left", "right"},
                                                                        {"Left", "Right"},
                                                                        {"LEFT", "RIGHT"},
                                                                        {"image_left", "image_right"},
                                                                        {"mav0/cam0", "mav0/cam1"},
                                                                        {"cam0", "cam1"},
                                                                        {"cam_left", "cam_right"}}};
    for (const auto& [left, right] : known) {
        const fs::path left_folder = fs::path(folder) / left;
        const fs::path right_folder = fs::path(folder) / right;
        if (base::is_folder(left_folder) && base::is_folder(right_folder)) {
            return std::pair(folder_of_images(left_folder), folder_of_images(right_folder));
        }
    }
    return std::nullopt;
}

std::optional<std::pair<std::string, std::string>> pair_of_folders(const std::string& uri) {
    for (std::size_t comma = uri.find(','); comma != std::string::npos; comma = uri.find(',', comma + 1)) {
        std::pair<std::string, std::string> pair{uri.substr(0, comma), uri.substr(comma + 1)};
        if (base::is_folder(pair.first) && base::is_folder(pair.second)) {
            return std::pair(folder_of_images(pair.first), folder_of_images(pair.second));
        }
    }
    return std::nullopt;
}

ImageSequence pair_images(const std::string& left, const std::string& right) {
    check_two_eyes(left, right);
    const std::vector<ImageName> left_names = names_of(left);
    std::map<std::string, std::string> by_stem, by_number;
    std::string two_of_a_number;
    for (const ImageName& name : names_of(right)) {
        by_stem.emplace(name.stem, name.file);
        if (const auto [there, is_new] = by_number.emplace(name.number, name.file); !is_new) {
            two_of_a_number = there->second + " and " + name.file;
        }
    }
    const bool same_names = by_stem.contains(left_names.front().stem);
    if (!same_names && !two_of_a_number.empty()) {
        throw std::invalid_argument(right + ": holds several images of one number, " + two_of_a_number +
                                    "; expected one for each left image, of the same name or number");
    }
    ImageSequence sequence;
    sequence.description = "images of two folders";
    for (const ImageName& name : left_names) {
        const auto& files = same_names ? by_stem : by_number;
        const auto found = files.find(same_names ? name.stem : name.number);
        const std::string file = (fs::path(left) / name.file).string();
        if (found == files.end() || (!same_names && name.number.empty())) {
            throw std::invalid_argument(file + ": has no right image, looked in " + right + " for one of the same " +
                                        (same_names ? "name" : "number"));
        }
        sequence.frames.push_back({file, (fs::path(right) / found->second).string(), 0, {}});
    }
    sequence.unpaired = unpaired_images(right, sequence.frames.size());
    take_times_of_names(sequence);
    return sequence;
}

std::string unpaired_images(const std::string& right, std::size_t pairs) {
    const std::size_t images = image_names(right).size();
    return images == pairs ? std::string()
                           : right + ": holds " + base::counted(images, "image") + " for " +
                                 base::counted(pairs, "left image") + "; those without a left one are left out";
}

std::optional<std::int64_t> time_of_name(std::string_view stem) {
    if (const auto point = stem.find('.'); point != std::string_view::npos) {
        const std::string_view seconds = stem.substr(0, point);
        std::string fraction(stem.substr(point + 1));
        if (!is_whole_number(seconds) || seconds.size() > 10 || !is_whole_number(fraction)) {
            return std::nullopt;
        }
        fraction.resize(9, '0');
        return value_of(seconds) * 1'000'000'000 + value_of(fraction);
    }
    struct Unit {
        std::size_t length;
        std::int64_t ns;
    };
    for (const Unit& unit : {Unit{19, 1}, Unit{16, 1'000}, Unit{13, 1'000'000}}) {
        // 9 at the front would not fit: the year 2255.
        if (is_whole_number(stem) && stem.size() == unit.length && stem.front() != '9') {
            return value_of(stem) * unit.ns;
        }
    }
    return std::nullopt;
}

void take_times_of_names(ImageSequence& sequence) {
    std::vector<std::int64_t> times;
    for (const ImageSequence::Frame& frame : sequence.frames) {
        const ImageName name(fs::path(frame.left).filename().string());
        // Beside other words a number is a time only where it is one since 1970.
        constexpr std::size_t least_digits = 13;
        const bool alone = name.number == name.stem;
        const bool since_1970 = name.number.size() >= least_digits && name.number.front() != '0';
        const auto time = alone || since_1970 ? time_of_name(name.number) : std::nullopt;
        if (!time || (!times.empty() && *time <= times.back())) {
            return;
        }
        times.push_back(*time);
    }
    for (std::size_t i = 0; i < times.size(); ++i) {
        sequence.frames[i].time_ns = times[i];
    }
    sequence.timed = !times.empty();
}

}  // namespace disparityd::capture
