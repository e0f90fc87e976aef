// SPDX-License-Identifier: Apache-2.0
#include "capture/images/image_header.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

namespace disparityd::capture {

namespace {

constexpr std::size_t head_size = 4096;

int side(std::uint64_t number) {
    return static_cast<int>(std::min<std::uint64_t>(number, std::numeric_limits<int>::max()));
}

/// Reads numbers anywhere in a file, in one byte order.
class Bytes {
public:
    Bytes(std::istream& file, bool big_endian) : file_(file), big_endian_(big_endian) {}

    /// Returns an unsigned number of 1 to 8 bytes; nothing beyond the end of the file.
    std::optional<std::uint64_t> number(std::uint64_t at, std::size_t size) {
        std::array<char, 8> bytes{};
        if (at > static_cast<std::uint64_t>(std::numeric_limits<std::streamoff>::max())) {
            return std::nullopt;
        }
        file_.clear();
        file_.seekg(static_cast<std::streamoff>(at));
        if (!file_.read(bytes.data(), static_cast<std::streamsize>(size))) {
            return std::nullopt;
        }
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < size; ++i) {
            const std::size_t from = big_endian_ ? i : size - 1 - i;
            value = (value << 8U) | static_cast<unsigned char>(bytes[from]);
        }
        return value;
    }

    std::optional<ImageSize> size(std::uint64_t width_at, std::uint64_t height_at, std::size_t bytes) {
        const auto width = number(width_at, bytes);
        const auto height = number(height_at, bytes);
        return width && height ? std::optional(ImageSize{side(*width), side(*height)}) : std::nullopt;
    }

private:
    std::istream& file_;
    bool big_endian_;
};

std::optional<ImageSize> size_of_png(std::istream& file, std::string_view head) {
    if (head.size() < 24 || head.substr(12, 4) != "IHDR") {
        return std::nullopt;
    }
    return Bytes(file, true).size(16, 20, 4);
}

std::optional<ImageSize> size_of_pnm(std::string_view head) {
    std::array<std::uint64_t, 2> numbers{};
    return read_pnm_numbers(head, numbers) == 0 ? std::nullopt
                                                : std::optional(ImageSize{side(numbers[0]), side(numbers[1])});
}

/// Calls `look` with the code and the place of each segment up to the pixels, until it returns true. A segment's data
/// begin 4 bytes behind its place.
template <typename Look>
void walk_jpeg(Bytes& bytes, const Look& look) {
    constexpr int most_segments = 4096;
    int most_filling = 4096;  // bytes, in all: each costs a seek
    std::uint64_t at = 2;
    for (int i = 0; i < most_segments; ++i) {
        auto marker = bytes.number(at, 2);
        while (marker == 0xffffU && most_filling-- > 0) {  // fill bytes
            marker = bytes.number(++at, 2);
        }
        if (!marker || (*marker >> 8U) != 0xff) {
            return;
        }
        const std::uint64_t code = *marker & 0xffU;
        if (look(code, at)) {
            return;
        }
        if (code == 0x01 || (code >= 0xd0 && code <= 0xd7)) {  // markers without a segment
            at += 2;
            continue;
        }
        const auto length = bytes.number(at + 2, 2);
        if (!length || *length < 2 || code == 0xda || code == 0xd9) {
            return;
        }
        at += 2 + *length;
    }
}

/// The size stands in the first "start of frame" segment.
std::optional<ImageSize> size_of_jpeg(std::istream& file) {
    Bytes bytes(file, true);
    std::optional<ImageSize> size;
    walk_jpeg(bytes, [&](std::uint64_t code, std::uint64_t at) {
        const bool begins_frame = code >= 0xc0 && code <= 0xcf && code != 0xc4 && code != 0xc8 && code != 0xcc;
        if (begins_frame) {
            size = bytes.size(at + 7, at + 5, 2);
        }
        return begins_frame;
    });
    return size;
}

std::optional<ImageSize> size_of_bmp(std::istream& file) {
    Bytes bytes(file, false);
    const auto header = bytes.number(14, 4);
    if (header == 12U) {
        return bytes.size(18, 20, 2);
    }
    const auto width = bytes.number(18, 4);
    const auto height = bytes.number(22, 4);
    if (!header || !width || !height) {
        return std::nullopt;
    }
    // A negative height: the top row comes first.
    const std::uint64_t rows = *height > 0x80000000U ? 0x100000000U - *height : *height;
    return ImageSize{side(*width), side(rows)};
}

/// The layout of TIFF, or of BigTIFF, whose numbers are longer.
struct TiffLayout {
    std::uint64_t first_directory_at;
    std::size_t offset_size;
    std::size_t count_size;
    std::uint64_t entry_size;
    std::uint64_t value_at;  ///< within an entry
};

std::optional<ImageSize> size_of_tiff(std::istream& file, bool big_endian, bool big) {
    const TiffLayout layout = big ? TiffLayout{8, 8, 8, 20, 12} : TiffLayout{4, 4, 2, 12, 8};
    Bytes bytes(file, big_endian);
    const auto directory = bytes.number(layout.first_directory_at, layout.offset_size);
    const auto count = directory ? bytes.number(*directory, layout.count_size) : std::nullopt;
    if (!count) {
        return std::nullopt;
    }
    constexpr std::uint64_t most_entries = 4096;
    ImageSize image, tile;
    for (std::uint64_t i = 0; i < std::min(*count, most_entries); ++i) {
        const std::uint64_t entry = *directory + layout.count_size + i * layout.entry_size;
        const auto tag = bytes.number(entry, 2);
        const auto type = bytes.number(entry + 2, 2);
        const std::size_t size = type == 3U ? 2 : type == 4U ? 4 : type == 16U ? 8 : 1;
        const auto value = bytes.number(entry + layout.value_at, size);
        if (!tag || !value) {
            return std::nullopt;
        }
        int* const wanted = tag == 256U   ? &image.width
                            : tag == 257U ? &image.height
                            : tag == 322U ? &tile.width
                            : tag == 323U ? &tile.height
                                          : nullptr;
        if (wanted != nullptr) {
            *wanted = std::max(*wanted, side(*value));  // of a tag that stands twice decoders may take either
        }
    }
    if (image.width == 0 || image.height == 0) {
        return std::nullopt;
    }
    // An image may be smaller than a tile of a usual size.
    constexpr int usual_tile = 4096;
    return ImageSize{tile.width > usual_tile ? std::max(image.width, tile.width) : image.width,
                     tile.height > usual_tile ? std::max(image.height, tile.height) : image.height};
}

std::optional<ImageSize> size_of_webp(std::istream& file, std::string_view head) {
    Bytes bytes(file, false);
    const std::string_view kind = head.substr(12, 4);
    if (kind == "VP8X") {
        const auto size = bytes.size(24, 27, 3);
        return size ? std::optional(ImageSize{size->width + 1, size->height + 1}) : std::nullopt;
    }
    if (kind == "VP8L") {
        const auto bits = bytes.number(21, 4);
        return bits ? std::optional(ImageSize{side((*bits & 0x3fffU) + 1), side((*bits >> 14U & 0x3fffU) + 1)})
                    : std::nullopt;
    }
    if (kind == "VP8 ") {
        const auto size = bytes.size(26, 28, 2);
        return size ? std::optional(ImageSize{size->width & 0x3fff, size->height & 0x3fff}) : std::nullopt;
    }
    return std::nullopt;
}

/// Reads the orientation in the first directory of a TIFF, or of EXIF data, which are one: it begins at `begin`.
int orientation_of_tiff(std::istream& file, std::uint64_t begin) {
    const auto mark = Bytes(file, true).number(begin, 4);
    const bool big_endian = mark == 0x4d4d002aU;
    if (!big_endian && mark != 0x49492a00U) {
        return 1;
    }
    Bytes bytes(file, big_endian);
    const auto directory = bytes.number(begin + 4, 4);
    const auto count = directory ? bytes.number(begin + *directory, 2) : std::nullopt;
    for (std::uint64_t i = 0; count && i < *count; ++i) {
        const std::uint64_t entry = begin + *directory + 2 + 12 * i;
        const auto tag = bytes.number(entry, 2);
        if (!tag) {
            break;
        }
        if (tag == 274U) {
            const auto value = bytes.number(entry + 8, 2);
            return value && *value >= 1 && *value <= 8 ? static_cast<int>(*value) : 1;
        }
    }
    return 1;
}

int orientation_of_jpeg(std::istream& file) {
    Bytes bytes(file, true);
    int orientation = 1;
    walk_jpeg(bytes, [&](std::uint64_t code, std::uint64_t at) {
        constexpr std::uint64_t app1 = 0xe1, exif = 0x45786966;
        const bool found = code == app1 && bytes.number(at + 4, 4) == exif;
        orientation = found ? orientation_of_tiff(file, at + 10) : orientation;
        return found;
    });
    return orientation;
}

/// PNG and WebP are chunks of a name and a length; `wanted` is the name of that with the EXIF data.
int orientation_in_chunks(std::istream& file, bool png, std::uint64_t wanted) {
    Bytes names(file, true);
    Bytes lengths(file, png);
    constexpr int most_chunks = 4096;
    std::uint64_t at = png ? 8 : 12;
    for (int i = 0; i < most_chunks; ++i) {
        const auto name = names.number(png ? at + 4 : at, 4);
        const auto length = lengths.number(png ? at : at + 4, 4);
        if (!name || !length) {
            break;
        }
        if (*name == wanted) {
            constexpr std::uint64_t exif = 0x45786966;  // some writers put JPEG's "Exif" before the data
            return orientation_of_tiff(file, at + 8 + (names.number(at + 8, 4) == exif ? 6 : 0));
        }
        at += png ? 12 + *length : 8 + *length + *length % 2;
    }
    return 1;
}

}  // namespace

std::size_t read_pnm_numbers(std::string_view head, std::span<std::uint64_t> numbers) {
    std::size_t at = 2;
    for (std::uint64_t& number : numbers) {
        for (;;) {
            while (at < head.size() && std::isspace(static_cast<unsigned char>(head[at])) != 0) {
                ++at;
            }
            if (at >= head.size() || head[at] != '#') {
                break;
            }
            at = std::min(head.find('\n', at), head.size());
        }
        const std::size_t start = at;
        while (at < head.size() && std::isdigit(static_cast<unsigned char>(head[at])) != 0 && at - start < 18) {
            number = 10 * number + static_cast<std::uint64_t>(head[at] - '0');
            ++at;
        }
        if (at == start || at == head.size()) {
            return 0;
        }
    }
    return at;
}

std::optional<ImageSize> read_image_header(std::istream& file) {
    std::array<char, head_size> bytes{};
    file.read(bytes.data(), bytes.size());
    const std::string_view head(bytes.data(), static_cast<std::size_t>(file.gcount()));
    using namespace std::string_view_literals;
    if (head.starts_with("\x89PNG\r\n\x1a\n")) {
        return size_of_png(file, head);
    }
    if (head.starts_with("\xff\xd8\xff")) {
        return size_of_jpeg(file);
    }
    if (head.size() > 2 && head[0] == 'P' && ((head[1] >= '1' && head[1] <= '6') || head[1] == 'f' || head[1] == 'F')) {
        return size_of_pnm(head);
    }
    if (head.starts_with("BM")) {
        return size_of_bmp(file);
    }
    if (head.starts_with("II*\0"sv) || head.starts_with("II+\0"sv)) {
        return size_of_tiff(file, false, head[2] == '+');
    }
    if (head.starts_with("MM\0*"sv) || head.starts_with("MM\0+"sv)) {
        return size_of_tiff(file, true, head[3] == '+');
    }
    if (head.starts_with("RIFF") && head.size() >= 30 && head.substr(8, 4) == "WEBP") {
        return size_of_webp(file, head);
    }
    return std::nullopt;
}

int read_image_orientation(std::istream& file) {
    std::array<char, 12> bytes{};
    file.clear();
    file.seekg(0);
    file.read(bytes.data(), bytes.size());
    const std::string_view head(bytes.data(), static_cast<std::size_t>(file.gcount()));
    if (head.starts_with("\xff\xd8\xff")) {
        return orientation_of_jpeg(file);
    }
    if (head.starts_with("\x89PNG")) {
        return orientation_in_chunks(file, true, 0x65584966);  // eXIf
    }
    if (head.starts_with("RIFF") && head.size() == 12 && head.substr(8) == "WEBP") {
        return orientation_in_chunks(file, false, 0x45584946);  // EXIF
    }
    return orientation_of_tiff(file, 0);
}

std::optional<std::uint64_t> read_largest_value(std::istream& file) {
    std::array<char, head_size> bytes{};
    file.read(bytes.data(), bytes.size());
    const std::string_view head(bytes.data(), static_cast<std::size_t>(file.gcount()));
    std::array<std::uint64_t, 3> numbers{};
    const bool states_it =
        head.starts_with("P2") || head.starts_with("P3") || head.starts_with("P5") || head.starts_with("P6");
    return states_it && read_pnm_numbers(head, numbers) != 0 ? std::optional(numbers[2]) : std::nullopt;
}

}  // namespace disparityd::capture
