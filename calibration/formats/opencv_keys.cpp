// SPDX-License-Identifier: Apache-2.0
#include "calibration/formats/opencv_keys.h"

#include <algorithm>
#include <array>
#include <map>

#include "base/message_text.h"
#include "base/number_text.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/lens_model.h"

namespace disparityd::calibration {

namespace {

using Name = std::string_view;

constexpr std::array<Name, 20> left_matrix_names{"m1",
                                                 "k1",
                                                 "cm1",
                                                 "cameramatrix1",
                                                 "kleft",
                                                 "leftk",
                                                 "mleft",
                                                 "leftm",
                                                 "kl",
                                                 "ml",
                                                 "mtx1",
                                                 "mtxl",
                                                 "mtxleft",
                                                 "leftmtx",
                                                 "leftcameramatrix",
                                                 "camera1matrix",
                                                 "cameramatrixl",
                                                 "cameramatrixleft",
                                                 "intrinsic1",
                                                 "leftintrinsics"};
constexpr std::array<Name, 20> right_matrix_names{"m2",
                                                  "k2",
                                                  "cm2",
                                                  "cameramatrix2",
                                                  "kright",
                                                  "rightk",
                                                  "mright",
                                                  "rightm",
                                                  "kr",
                                                  "mr",
                                                  "mtx2",
                                                  "mtxr",
                                                  "mtxright",
                                                  "rightmtx",
                                                  "rightcameramatrix",
                                                  "camera2matrix",
                                                  "cameramatrixr",
                                                  "cameramatrixright",
                                                  "intrinsic2",
                                                  "rightintrinsics"};
constexpr std::array<Name, 15> left_distortion_names{"d1",          "distcoeffs1",    "distortioncoefficients1",
                                                     "dleft",       "leftd",          "dl",
                                                     "dist1",       "distl",          "distleft",
                                                     "leftdist",    "leftdistcoeffs", "distcoeffsleft",
                                                     "distcoeffsl", "distortion1",    "leftdistortion"};
constexpr std::array<Name, 15> right_distortion_names{"d2",          "distcoeffs2",     "distortioncoefficients2",
                                                      "dright",      "rightd",          "dr",
                                                      "dist2",       "distr",           "distright",
                                                      "rightdist",   "rightdistcoeffs", "distcoeffsright",
                                                      "distcoeffsr", "distortion2",     "rightdistortion"};
constexpr std::array<Name, 6> rotations_names{"r", "rotation", "rotationmatrix", "rmat", "stereor", "rot"};
constexpr std::array<Name, 7> translations_names{"t",     "translation", "translationvector", "tvec", "stereot",
                                                 "trans", "tmat"};
constexpr std::array<Name, 7> single_camera_names{"cameramatrix",    "k",          "m",        "mtx",
                                                  "intrinsicmatrix", "intrinsics", "intrinsic"};
constexpr std::array<Name, 7> units_names{"unit",  "units",        "lengthunit", "translationunit",
                                          "tunit", "baselineunit", "unitoft"};
constexpr std::array<Name, 10> models_names{"cameramodel", "distortionmodel", "lensmodel", "model",    "distortiontype",
                                            "cameratype",  "projectionmodel", "modeltype", "lenstype", "lens"};

/// How every pixel moves: homographies and tables.
constexpr std::array<Name, 2> homography_names{"h1", "h2"};
constexpr std::array<Name, 8> map_beginnings{"map",           "stereomap",      "leftmap",    "rightmap",
                                             "leftstereomap", "rightstereomap", "rectifymap", "undistortmap"};

/// What is left of the images; how good the calibration was; how it was made.
constexpr std::array<Name, 52> harmless_names{"roi1",
                                              "roi2",
                                              "validroi1",
                                              "validroi2",
                                              "validpixroi1",
                                              "validpixroi2",
                                              "rms",
                                              "rmserror",
                                              "rms1",
                                              "rms2",
                                              "rmsleft",
                                              "rmsright",
                                              "stereorms",
                                              "rmsstereo",
                                              "error",
                                              "meanerror",
                                              "reprojectionerror",
                                              "epipolarerror",
                                              "totalavgerr",
                                              "ret",
                                              "retval",
                                              "nframes",
                                              "nrofframes",
                                              "nimages",
                                              "numimages",
                                              "nviews",
                                              "numviews",
                                              "aspectratio",
                                              "fixaspectratio",
                                              "flags",
                                              "flagvalue",
                                              "pattern",
                                              "squaresize",
                                              "squaresizemm",
                                              "markersize",
                                              "imagelist",
                                              "imagepoints",
                                              "objectpoints",
                                              "gridpoints",
                                              "extrinsicparameters",
                                              "date",
                                              "time",
                                              "timestamp",
                                              "comment",
                                              "description",
                                              "name",
                                              "cameraname",
                                              "serial",
                                              "serialnumber",
                                              "version",
                                              "software",
                                              "opencvversion"};
constexpr std::array<Name, 7> harmless_beginnings{"calibrationtime", "calibrationdate", "board",        "chessboard",
                                                  "patternsize",     "avgreproj",       "perviewreproj"};

struct SidePair {
    Name width;
    Name height;
};
constexpr std::array<SidePair, 9> side_pairs{{{"imagewidth", "imageheight"},
                                              {"imgwidth", "imgheight"},
                                              {"width", "height"},
                                              {"framewidth", "frameheight"},
                                              {"camerawidth", "cameraheight"},
                                              {"leftwidth", "leftheight"},
                                              {"rightwidth", "rightheight"},
                                              {"resolutionx", "resolutiony"},
                                              {"cols", "rows"}}};
constexpr std::array<Name, 10> size_lists{"imagesize",  "size",           "imgsize",         "framesize",
                                          "camerasize", "resolution",     "imageresolution", "imagedimensions",
                                          "sizeimage",  "calibrationsize"};
/// Python's order: rows, columns, and perhaps channels.
constexpr std::array<Name, 4> shape_lists{"imageshape", "imgshape", "shape", "frameshape"};

bool contains(std::span<const Name> names, Name plain) {
    return std::find(names.begin(), names.end(), plain) != names.end();
}

[[noreturn]] void refuse_size(const OpencvStorage& file, const std::string& path, const std::string& name,
                              const std::string& allowed) {
    refuse_calibration(path, base::printable(name) + ": found " + file.shown(name) + ", expected " + allowed);
}

std::string size_of(double width, double height) {
    return base::number_text(width) + "x" + base::number_text(height);
}

/// Compares one entry; returns whether it is a size at all.
bool check_entry(const OpencvStorage& file, const std::string& path, const std::string& name, int width, int height) {
    const std::string plain = plain_name(name);
    const bool shape = contains(shape_lists, plain);
    if (shape || contains(size_lists, plain)) {
        auto found = file.numbers(name);
        found = found ? found : base::parse_numbers(file.word(name), " xX,");  // "1280x720"
        if (!found || !(found->size() == 2 || (shape && found->size() == 3))) {
            refuse_size(file, path, name, shape ? "height and width" : "width and height");
        }
        const double found_width = (*found)[shape ? 1 : 0];
        const double found_height = (*found)[shape ? 0 : 1];
        if (found_width != width || found_height != height) {
            refuse_other_size(path, size_of(found_width, found_height) + " (" + base::printable(name) + ")", width,
                              height);
        }
        return true;
    }
    for (const SidePair& pair : side_pairs) {
        if (plain == pair.width || plain == pair.height) {
            const auto found = file.numbers(name);
            if (!found || found->size() != 1) {
                refuse_size(file, path, name, "a number of pixels");
            }
            if ((*found)[0] != (plain == pair.width ? width : height)) {
                refuse_calibration(path, base::printable(name) + ": is for eyes of " + base::number_text((*found)[0]) +
                                             " pixels there, the frames have " + base::size_text(width, height) +
                                             ": use a mode or a calibration of the other size");
            }
            return true;
        }
    }
    return false;
}

}  // namespace

const EyeKeys left_eye_keys{left_matrix_names, left_distortion_names};
const EyeKeys right_eye_keys{right_matrix_names, right_distortion_names};
const std::span<const Name> rotation_keys{rotations_names};
const std::span<const Name> translation_keys{translations_names};
const std::span<const Name> single_camera_keys{single_camera_names};
const std::span<const Name> unit_keys{units_names};
const std::span<const Name> model_keys{models_names};

bool is_among(Name name, std::span<const Name> names) {
    return contains(names, plain_name(name));
}

bool is_harmless_key(Name name) {
    const std::string plain = plain_name(name);
    return contains(harmless_names, plain) || std::any_of(harmless_beginnings.begin(), harmless_beginnings.end(),
                                                          [&](Name beginning) { return plain.starts_with(beginning); });
}

bool is_map_key(Name name) {
    const std::string plain = plain_name(name);
    return contains(homography_names, plain) ||
           std::any_of(map_beginnings.begin(), map_beginnings.end(),
                       [&](Name beginning) { return plain.starts_with(beginning); });
}

bool is_size_key(Name name) {
    const std::string plain = plain_name(name);
    return contains(size_lists, plain) || contains(shape_lists, plain) ||
           std::any_of(side_pairs.begin(), side_pairs.end(),
                       [&](const SidePair& pair) { return plain == pair.width || plain == pair.height; });
}

bool check_sizes(const OpencvStorage& file, const std::string& path, int width, int height) {
    // Both sides of a pair are told at once where both are there: people look for "1280x720".
    std::map<std::string, double, std::less<>> sides;
    for (const std::string& name : file.names()) {
        const auto found = file.numbers(name);
        if (found && found->size() == 1) {
            sides.emplace(plain_name(name), found->front());
        }
    }
    for (const SidePair& pair : side_pairs) {
        const auto found_width = sides.find(pair.width);
        const auto found_height = sides.find(pair.height);
        if (found_width != sides.end() && found_height != sides.end() &&
            (found_width->second != width || found_height->second != height)) {
            refuse_other_size(path, size_of(found_width->second, found_height->second), width, height);
        }
    }
    bool stated = false;
    for (const std::string& name : file.names()) {
        stated = check_entry(file, path, name, width, height) || stated;
    }
    return stated;
}

}  // namespace disparityd::calibration
