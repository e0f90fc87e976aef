// SPDX-License-Identifier: Apache-2.0
#include "tools/images/image_file.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <filesystem>
#include <stdexcept>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/write_all.h"
#include "base/write_failure.h"
#include "base/write_target.h"
#include "capture/images/image_files.h"
#include "formats/pictures/jpeg_writer.h"
#include "formats/pictures/png_writer.h"

namespace disparityd::images {
namespace {

/// The name of the unfinished file; of this thread alone, as several write at once, and long names begin alike.
std::string unfinished_name(const std::string& target) {
    const std::filesystem::path path(target);
    // The name itself may be as long as names can be.
    return (path.parent_path() / ("." + path.filename().string().substr(0, 200) + '.' + std::to_string(gettid())))
        .string();
}

/// A new file beside the target; -1 where there can be none.
int open_beside(const std::string& target) {
    const std::string name = unfinished_name(target);
    unlink(name.c_str());  // of an earlier thread with this number, whose process was killed
    return open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
}

/// Puts the new file in place of the target, whole or not at all; `path` is for messages.
void replace(const std::string& path, const base::WriteTarget& target, int beside,
             std::span<const std::uint8_t> bytes) {
    const std::string unfinished = unfinished_name(target.path);
    int failure = base::write_all(beside, std::as_bytes(bytes));
    if (target.mode) {
        fchmod(beside, *target.mode);
    }
    if (close(beside) != 0 && failure == 0) {
        failure = errno;
    }
    if (failure == 0 && rename(unfinished.c_str(), target.path.c_str()) != 0) {
        failure = errno;
    }
    if (failure != 0) {
        unlink(unfinished.c_str());
        base::refuse_to_write(path, failure);
    }
}

/// Writes what `encode` makes; what it throws gets the name of the file.
template <typename Encode>
void write_encoded(const std::string& path, const Encode& encode) {
    std::string bytes;
    try {
        bytes = encode();
    } catch (const std::runtime_error& refusal) {
        throw std::runtime_error(path + ": " + refusal.what());
    }
    write_file(path, bytes);
}

}  // namespace

void write_file(const std::string& path, std::span<const std::uint8_t> bytes) {
    const base::WriteTarget target = base::write_target(path);
    const int beside = target.special ? -1 : open_beside(target.path);
    if (!target.special && beside < 0 && errno != EACCES && errno != EPERM && errno != EROFS) {
        base::refuse_to_write(path, errno);
    }
    if (beside >= 0) {
        replace(path, target, beside, bytes);
        return;
    }
    // Where no file may be made beside it, writing into the one that is there may be allowed all the same.
    const int itself = open(target.path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (itself < 0) {
        base::refuse_to_write(path, errno);
    }
    const int failure = base::write_all(itself, std::as_bytes(bytes));
    if (const int closing = close(itself) == 0 ? 0 : errno; failure != 0 || closing != 0) {
        base::refuse_to_write(path, failure != 0 ? failure : closing);
    }
}

void write_file(const std::string& path, std::string_view text) {
    write_file(path, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

void write_png(const std::string& path, const cv::Mat& picture) {
    write_encoded(path, [&] {
        return formats::png_of({picture.data, picture.cols, picture.rows, picture.step, picture.channels(),
                                static_cast<int>(8 * picture.elemSize1())},
                               formats::PngContent::picture);
    });
}

void check_ending(const std::string& path, std::initializer_list<const char*> allowed) {
    std::string list;
    for (const char* ending : allowed) {
        if (has_ending(path, ending)) {
            return;
        }
        list += (list.empty() ? "" : ", ") + std::string(ending);
    }
    const std::string found = std::filesystem::path(path).extension().string();
    throw std::invalid_argument(path + ": the ending says which format is written: found " +
                                (found.empty() ? "none" : found) + ", allowed: " + list);
}

bool has_ending(const std::string& path, const char* ending) {
    std::string found = std::filesystem::path(path).extension().string();
    std::transform(found.begin(), found.end(), found.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return found == ending;
}

void check_picture_name(const std::string& path) {
    check_ending(path, {".png", ".jpg", ".jpeg"});
}

void write_picture(const std::string& path, const cv::Mat& picture) {
    check_picture_name(path);
    if (has_ending(path, ".png")) {
        write_png(path, picture);
    } else {
        constexpr int quality = 95;  // text and thin lines stay sharp
        write_encoded(path, [&] { return jpeg_of(picture, quality); });
    }
}

std::string jpeg_of(const cv::Mat& picture, int quality) {
    return formats::jpeg_of(
        {picture.data, picture.cols, picture.rows, static_cast<int>(picture.step), picture.channels() == 1}, quality,
        formats::JpegTransform::accurate);
}

cv::Mat read_image(const std::string& path) {
    return capture::decode_image(path);
}

}  // namespace disparityd::images
