// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <stdexcept>

#include <opencv2/imgproc.hpp>
#include <tiffio.h>

#include "capture/images/image_decoders.h"

namespace disparityd::capture {
namespace {

/// A file in memory, as libtiff reads it.
struct TiffBytes {
    std::span<const std::uint8_t> bytes;
    std::uint64_t at = 0;
};

TiffBytes& tiff_bytes_of(thandle_t handle) {
    return *static_cast<TiffBytes*>(handle);
}

tmsize_t read_tiff_bytes(thandle_t handle, void* to, tmsize_t wanted) {
    TiffBytes& contents = tiff_bytes_of(handle);
    const std::uint64_t left = contents.bytes.size() - std::min<std::uint64_t>(contents.at, contents.bytes.size());
    const std::uint64_t count = std::min(left, static_cast<std::uint64_t>(std::max<tmsize_t>(wanted, 0)));
    if (count > 0) {
        std::memcpy(to, contents.bytes.data() + contents.at, count);
    }
    contents.at += count;
    return static_cast<tmsize_t>(count);
}

tmsize_t write_nothing(thandle_t /*handle*/, void* /*from*/, tmsize_t /*size*/) {
    return -1;
}

toff_t seek_tiff_bytes(thandle_t handle, toff_t offset, int from) {
    TiffBytes& contents = tiff_bytes_of(handle);
    contents.at = offset + (from == SEEK_CUR ? contents.at : from == SEEK_END ? contents.bytes.size() : 0);
    return contents.at;
}

int close_nothing(thandle_t /*handle*/) {
    return 0;
}

toff_t size_of_tiff_bytes(thandle_t handle) {
    return tiff_bytes_of(handle).bytes.size();
}

struct CloseTiff {
    void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};
using OwnedTiff = std::unique_ptr<TIFF, CloseTiff>;

/// What libtiff would write to stderr is said in one line of ours.
OwnedTiff open_tiff(TiffBytes& contents) {
    [[maybe_unused]] static const bool silent = [] {
        TIFFSetErrorHandler(nullptr);
        TIFFSetWarningHandler(nullptr);
        return true;
    }();
    return OwnedTiff(TIFFClientOpen("picture", "rm", &contents, read_tiff_bytes, write_nothing, seek_tiff_bytes,
                                    close_nothing, size_of_tiff_bytes, nullptr, nullptr));
}

bool is_taken(std::uint32_t side) {
    return side > 0 && side <= static_cast<std::uint32_t>(largest_image_side);
}

/// What the file says of its pixels.
struct TiffPixels {
    std::uint32_t width = 0, height = 0;
    std::uint16_t bits = 1, channels = 1, format = SAMPLEFORMAT_UINT, planes = PLANARCONFIG_CONTIG, colours = 0,
                  orientation = ORIENTATION_TOPLEFT;

    /// With alpha, too.
    bool grey() const {
        return channels <= 2 && (colours == PHOTOMETRIC_MINISBLACK || colours == PHOTOMETRIC_MINISWHITE);
    }
    /// Whether these are values of 16 bits that are read as they are.
    bool deep() const {
        const bool colour = (channels == 3 || channels == 4) && colours == PHOTOMETRIC_RGB;
        return bits == 16 && format == SAMPLEFORMAT_UINT && planes == PLANARCONFIG_CONTIG &&
               (colour || (channels == 1 && colours == PHOTOMETRIC_MINISBLACK));
    }
};

TiffPixels layout_of(TIFF* tiff) {
    TiffPixels layout;
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &layout.width);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &layout.height);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &layout.bits);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &layout.channels);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &layout.format);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &layout.planes);
    TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &layout.colours);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_ORIENTATION, &layout.orientation);
    return layout;
}

const char* name_of_format(std::uint16_t format) {
    switch (format) {
        case SAMPLEFORMAT_UINT: return "unsigned";
        case SAMPLEFORMAT_INT: return "signed";
        case SAMPLEFORMAT_IEEEFP: return "floats";
        default: return "of another kind";
    }
}

/// Whether what libtiff decodes at once is no larger than the largest image: a small file may claim tiles and strips of
/// gigabytes.
bool fits(TIFF* tiff, const TiffPixels& layout) {
    constexpr tmsize_t most = tmsize_t{largest_image_side} * largest_image_side * 4;
    if (TIFFIsTiled(tiff) == 0) {
        return TIFFStripSize(tiff) <= most && tmsize_t{layout.width} * layout.height * layout.channels <= most;
    }
    std::uint32_t width = 0, height = 0;
    TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &width);
    TIFFGetField(tiff, TIFFTAG_TILELENGTH, &height);
    return is_taken(width) && is_taken(height) && TIFFTileSize(tiff) <= most;
}

/// libtiff makes colours of all that has up to 8 bits. An empty image: it refuses.
cv::Mat read_colours(TIFF* tiff, const TiffPixels& layout) {
    cv::Mat rgba(static_cast<int>(layout.height), static_cast<int>(layout.width), CV_8UC4);
    if (TIFFReadRGBAImageOriented(tiff, layout.width, layout.height, reinterpret_cast<std::uint32_t*>(rgba.data),
                                  ORIENTATION_TOPLEFT, 1) == 0) {
        return {};
    }
    cv::Mat image;
    if (layout.grey()) {
        cv::extractChannel(rgba, image, 0);
    } else {
        cv::cvtColor(rgba, image, layout.channels == 4 ? cv::COLOR_RGBA2BGRA : cv::COLOR_RGBA2BGR);
    }
    return image;
}

bool read_tiles(TIFF* tiff, cv::Mat& image) {
    std::uint32_t width = 0, height = 0;
    TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &width);
    TIFFGetField(tiff, TIFFTAG_TILELENGTH, &height);
    const cv::Size size(static_cast<int>(width), static_cast<int>(height));
    cv::Mat tile(size, image.type());
    const auto bytes = static_cast<tmsize_t>(tile.total() * tile.elemSize());
    if (TIFFTileSize(tiff) != bytes) {
        return false;
    }
    const cv::Rect all({0, 0}, image.size());
    for (int y = 0; y < image.rows; y += size.height) {
        for (int x = 0; x < image.cols; x += size.width) {
            const auto number =
                TIFFComputeTile(tiff, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 0, 0);
            if (TIFFReadEncodedTile(tiff, number, tile.data, bytes) != bytes) {
                return false;
            }
            const cv::Rect place = cv::Rect({x, y}, size) & all;
            tile(cv::Rect({0, 0}, place.size())).copyTo(image(place));
        }
    }
    return true;
}

bool read_rows(TIFF* tiff, cv::Mat& image) {
    if (TIFFScanlineSize(tiff) != static_cast<tmsize_t>(static_cast<std::size_t>(image.cols) * image.elemSize())) {
        return false;
    }
    for (int y = 0; y < image.rows; ++y) {
        if (TIFFReadScanline(tiff, image.ptr(y), static_cast<std::uint32_t>(y), 0) != 1) {
            return false;
        }
    }
    return true;
}

/// Reads 16 bits for each channel as they are. An empty image: libtiff refuses.
cv::Mat read_deep(TIFF* tiff, const TiffPixels& layout) {
    cv::Mat image(static_cast<int>(layout.height), static_cast<int>(layout.width), CV_16UC(layout.channels));
    if (!(TIFFIsTiled(tiff) != 0 ? read_tiles(tiff, image) : read_rows(tiff, image))) {
        return {};
    }
    if (layout.channels > 1) {
        cv::cvtColor(image, image, layout.channels == 4 ? cv::COLOR_RGBA2BGRA : cv::COLOR_RGB2BGR);
    }
    return image;
}

}  // namespace

cv::Mat decode_tiff(std::span<const std::uint8_t> file, const std::string& path) {
    const auto refuse = [&](const std::string& why) { throw std::invalid_argument(path + ": " + why); };
    TiffBytes contents{file};
    const OwnedTiff tiff = open_tiff(contents);
    if (tiff == nullptr) {
        refuse("is damaged, or no TIFF that libtiff can read");
    }
    const TiffPixels layout = layout_of(tiff.get());
    if (!is_taken(layout.width) || !is_taken(layout.height) || !fits(tiff.get(), layout)) {
        refuse("is damaged: the TIFF says no size that is taken");
    }
    if (layout.orientation != ORIENTATION_TOPLEFT) {
        refuse_turned_image(path, layout.orientation);
    }
    if (!layout.deep() && (layout.bits > 8 || layout.channels > 4)) {
        refuse("found pixels of " + std::to_string(layout.bits) + " bits (a TIFF of " +
               std::to_string(layout.channels) + " channels, " + name_of_format(layout.format) + ", photometric " +
               std::to_string(layout.colours) +
               "), allowed are 8 and 16 bits, up to 4 channels; those of 16 unsigned, grey (0 is black) or red, green, "
               "blue side by side: convert it to PNG");
    }
    std::array<char, 1024> why{};
    if (!layout.deep() && TIFFRGBAImageOK(tiff.get(), why.data()) == 0) {
        refuse(std::string("found a TIFF that is not read (libtiff says: ") + why.data() + "): convert it to PNG");
    }
    cv::Mat image = layout.deep() ? read_deep(tiff.get(), layout) : read_colours(tiff.get(), layout);
    if (image.empty()) {
        refuse("is damaged: libtiff cannot decode it");
    }
    return image;
}

}  // namespace disparityd::capture
