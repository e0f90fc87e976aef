// SPDX-License-Identifier: Apache-2.0
// The Python module disparity_matcher._matcher: matching, rectification, calibration. The package around it checks what
// its users give and documents it; _matcher.pyi has the types.
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "bindings/python/native/file_names.h"
#include "bindings/python/native/forked_pair_matcher.h"
#include "bindings/python/native/measures.h"
#include "calibration/calibration.h"
#include "calibration/lens.h"
#include "calibration/rectification.h"
#include "kernels/match_choice.h"
#include "kernels/steps.h"

namespace py = pybind11;

namespace disparityd::bindings {
namespace {

using calibration::CameraModel;
using calibration::Rectification;
using calibration::StereoCalibration;
using Bytes = py::array_t<std::uint8_t>;
using Sixteenths = py::array_t<std::int16_t>;
using Floats = py::array_t<float>;

std::string spelled(std::string_view name) {
    return std::string(name);
}

int extent(const py::array& array, int axis) {
    return static_cast<int>(array.shape(axis));
}

/// A view of an array of height x width, or x channels, whose rows have no gaps; the package has seen to that.
template <typename T>
Plane<T> plane_of(T* data, const py::array& array) {
    const int channels = array.ndim() == 3 ? extent(array, 2) : 1;
    return {data, extent(array, 1) * channels, extent(array, 0),
            static_cast<std::ptrdiff_t>(array.strides(0) / static_cast<py::ssize_t>(sizeof(T)))};
}

Plane<const std::uint8_t> image_of(const Bytes& array) {
    return plane_of(array.data(), array);
}

MatchOptions options_of(const std::string& method, const std::string& preset, const std::string& cost,
                        const std::map<std::string, std::int64_t>& given) {
    MatchChoice choice{preset, cost, {}};
    for (const MatchField& field : match_fields()) {
        if (const auto found = given.find(std::string(field.name)); found != given.end()) {
            check_allowed(field, found->second, std::to_string(found->second), spelled);
            choice.given[field.name] = static_cast<int>(found->second);
        }
    }
    const std::array methods{method_of(method, spelled)};
    check_used(choice, methods, spelled);
    constexpr int usual_disparities = 64;
    return chosen_options(choice, methods[0], Preset::dense, usual_disparities, spelled);
}

py::dict as_dict(const MatchOptions& options) {
    py::dict all;
    all["method"] = std::string(to_string(options.method));
    all["cost"] = std::string(to_string(options.cost));
    for (const MatchField& field : match_fields()) {
        const int value = field.value(options);
        all[py::str(std::string(field.name))] = field.is_switch() ? py::object(py::bool_(value != 0)) : py::int_(value);
    }
    return all;
}

/// The rows of match_fields(): (name, whether it is a switch, what is allowed, what it does).
std::vector<std::tuple<std::string, bool, std::string, std::string>> fields() {
    std::vector<std::tuple<std::string, bool, std::string, std::string>> rows;
    for (const MatchField& field : match_fields()) {
        rows.emplace_back(field.name, field.is_switch(), field.is_switch() ? "True or False" : field.allowed(),
                          field.help);
    }
    return rows;
}

template <typename All>
std::vector<std::string> names_of(const All& all) {
    std::vector<std::string> names;
    names.reserve(all.size());
    for (const auto one : all) {
        names.emplace_back(to_string(one));
    }
    return names;
}

void match(ForkedPairMatcher& matcher, const Bytes& left, const Bytes& right, Sixteenths disparity, Bytes confidence) {
    const auto left_image = image_of(left);
    const auto right_image = image_of(right);
    PairResults results;
    results.disparity = plane_of(disparity.mutable_data(), disparity);
    results.confidence = plane_of(confidence.mutable_data(), confidence);
    matcher.prepare();
    const py::gil_scoped_release others_run;
    matcher.match(left_image, right_image, results);
}

/// Refuses gaps and other shapes: pixels are read one after the other.
void check_pixels(const py::array& array, const py::array& like) {
    constexpr int wanted = int{py::array::c_style} | int{py::detail::npy_api::NPY_ARRAY_ALIGNED_};
    if (array.ndim() != 2 || (array.flags() & wanted) != wanted || array.shape(0) != like.shape(0) ||
        array.shape(1) != like.shape(1)) {
        throw std::invalid_argument(
            "disparity and confidence: allowed are arrays of one shape (height, width), without gaps between their "
            "pixels");
    }
}

/// A new array of the size of disparities, which are checked.
Floats like(const Sixteenths& disparity) {
    check_pixels(disparity, disparity);
    return Floats({disparity.shape(0), disparity.shape(1)});
}

Floats disparity_px(const Sixteenths& disparity, std::int16_t invalid) {
    Floats out = like(disparity);
    const auto count = static_cast<std::size_t>(disparity.size());
    const std::int16_t* const from = disparity.data();
    float* const to = out.mutable_data();
    const py::gil_scoped_release others_run;
    to_px(from, count, invalid, to);
    return out;
}

Floats depth_m(const Sixteenths& disparity, std::int16_t invalid, double focal_baseline, double offset) {
    Floats out = like(disparity);
    const auto count = static_cast<std::size_t>(disparity.size());
    const std::int16_t* const from = disparity.data();
    float* const to = out.mutable_data();
    const py::gil_scoped_release others_run;
    to_metres(from, count, invalid, {focal_baseline, offset}, to);
    return out;
}

Floats depth_error_m(const Sixteenths& disparity, const Bytes& confidence, double focal_baseline, double offset,
                     double sigma_px) {
    Floats out = like(disparity);
    check_pixels(confidence, disparity);
    const auto count = static_cast<std::size_t>(disparity.size());
    const std::int16_t* const from = disparity.data();
    const std::uint8_t* const sure = confidence.data();
    float* const to = out.mutable_data();
    const py::gil_scoped_release others_run;
    to_metre_errors(from, sure, count, {focal_baseline, offset}, sigma_px, to);
    return out;
}

/// A rectification and the size that frames must have for it.
struct RectifiedCapture {
    Rectification maps;
    int width;
    int height;
};

RectifiedCapture rectification_of(const StereoCalibration& calibration, int width, int height,
                                  const std::array<int, 4>& region) {
    calibration::RectifiedGeometry geometry{width, height, {region[0], region[1], region[2], region[3]}};
    const py::gil_scoped_release others_run;
    return {make_rectification(calibration, calibration.width, calibration.height, geometry), calibration.width,
            calibration.height};
}

/// Takes one eye's picture to `out`: grey, or BGR where `out` has three channels. No maps: as it is.
void rectify(const RectifiedCapture* capture, bool right_eye, const Bytes& image, Bytes out) {
    const bool colour = image.ndim() == 3;
    const auto source = image_of(image);
    const Plane<std::uint8_t> target = plane_of(out.mutable_data(), out);
    const bool to_colour = out.ndim() == 3;
    const int width = capture != nullptr ? capture->maps.width : extent(image, 1);
    const int height = capture != nullptr ? capture->maps.height : source.height;
    if (extent(out, 1) != width || target.height != height ||
        (capture != nullptr && (extent(image, 1) != capture->width || source.height != capture->height))) {
        throw std::invalid_argument("the image or its target have another size than the rectification");
    }
    RawImage raw{source.data, colour ? PixelFormat::bgr24 : PixelFormat::grey8, extent(image, 1), source.height,
                 source.stride};
    Rectifier rectifier = capture != nullptr ? capture->maps.rectifier() : Rectifier{};
    if (right_eye) {
        rectifier.left = rectifier.right;  // each eye has a picture of its own here, as if it were the left one
    }
    const py::gil_scoped_release others_run;
    const FrameSteps& steps = fastest_frame_steps();
    const Rows all{0, target.height};
    (to_colour ? steps.rectify_colour : steps.rectify)(raw, Eye::left, rectifier, target, all);
}

py::array_t<double> matrix(const double* values, py::ssize_t rows, py::ssize_t columns) {
    return py::array_t<double>({rows, columns}, values);
}

py::array_t<double> camera_matrix(const CameraModel& camera) {
    const std::array<double, 9> k{camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
    return matrix(k.data(), 3, 3);
}

void add_matching(py::module_& m) {
    m.def("fields", fields);
    m.attr("methods") = names_of(all_methods);
    m.attr("costs") = names_of(all_costs);
    m.attr("presets") = names_of(all_presets);
    py::class_<MatchOptions>(m, "MatchOptions")
        .def(py::init(&options_of), py::arg("method"), py::arg("preset"), py::arg("cost"), py::arg("given"))
        .def("as_dict", as_dict)
        .def_property_readonly("invalid", [](const MatchOptions& of) { return invalid_disparity(of.range); });
    py::class_<ForkedPairMatcher>(m, "PairMatcher")
        .def(py::init<int, int, const MatchOptions&, const std::string&, int>(), py::arg("width"), py::arg("height"),
             py::arg("options"), py::arg("backend"), py::arg("threads"), py::call_guard<py::gil_scoped_release>())
        .def("match", match, py::arg("left").noconvert(), py::arg("right").noconvert(),
             py::arg("disparity").noconvert(), py::arg("confidence").noconvert())
        .def_property_readonly("trouble", &ForkedPairMatcher::trouble);
    m.def("check_backend", [](const std::string& name) { backend(name); });
    m.def("disparity_px", disparity_px, py::arg("disparity").noconvert(), py::arg("invalid"));
    m.def("depth_m", depth_m, py::arg("disparity").noconvert(), py::arg("invalid"), py::arg("focal_baseline"),
          py::arg("offset"));
    m.def("depth_error_m", depth_error_m, py::arg("disparity").noconvert(), py::arg("confidence").noconvert(),
          py::arg("focal_baseline"), py::arg("offset"), py::arg("sigma_px"));
}

void add_calibration(py::module_& m) {
    py::class_<StereoCalibration>(m, "StereoCalibration")
        .def_static(
            "read",
            [](const std::string& path, int width, int height) {
                return calibration::read_calibration(path, width, height);
            },
            py::arg("path"), py::arg("width"), py::arg("height"))
        .def_static("from_text", calibration::calibration_from_text, py::arg("text"), py::arg("origin"))
        .def("to_text", calibration::to_text)
        .def("to_opencv_yaml", calibration::to_opencv_yaml)
        .def_readonly("width", &StereoCalibration::width)
        .def_readonly("height", &StereoCalibration::height)
        .def_readonly("rectified", &StereoCalibration::rectified)
        .def_property_readonly("origin", [](const StereoCalibration& of) { return text_with_names(of.origin); })
        .def_property_readonly("K_left", [](const StereoCalibration& of) { return camera_matrix(of.left); })
        .def_property_readonly("K_right", [](const StereoCalibration& of) { return camera_matrix(of.right); })
        .def_property_readonly("D_left", [](const StereoCalibration& of) { return lens_coefficients(of.left); })
        .def_property_readonly("D_right", [](const StereoCalibration& of) { return lens_coefficients(of.right); })
        .def_property_readonly("fisheye",
                               [](const StereoCalibration& of) {
                                   return std::pair(of.left.lens == calibration::LensModel::fisheye,
                                                    of.right.lens == calibration::LensModel::fisheye);
                               })
        .def_property_readonly("R", [](const StereoCalibration& of) { return matrix(of.rotation.data(), 3, 3); })
        .def_property_readonly("T", [](const StereoCalibration& of) { return matrix(of.translation.data(), 3, 1); });
    py::class_<RectifiedCapture>(m, "Rectification")
        .def(py::init(&rectification_of), py::arg("calibration"), py::arg("width"), py::arg("height"),
             py::arg("region"))
        .def_readonly("capture_width", &RectifiedCapture::width)
        .def_readonly("capture_height", &RectifiedCapture::height)
        .def_property_readonly("width", [](const RectifiedCapture& of) { return of.maps.width; })
        .def_property_readonly("height", [](const RectifiedCapture& of) { return of.maps.height; })
        .def_property_readonly("f", [](const RectifiedCapture& of) { return of.maps.f; })
        .def_property_readonly("cx", [](const RectifiedCapture& of) { return of.maps.cx; })
        .def_property_readonly("cy", [](const RectifiedCapture& of) { return of.maps.cy; })
        .def_property_readonly("baseline_mm", [](const RectifiedCapture& of) { return of.maps.baseline_mm; })
        .def_property_readonly("disparity_offset", [](const RectifiedCapture& of) { return of.maps.disparity_offset; })
        .def_property_readonly("calibration_id", [](const RectifiedCapture& of) { return of.maps.calibration_id; })
        .def_property_readonly("R_left",
                               [](const RectifiedCapture& of) { return matrix(of.maps.left_rotation.data(), 3, 3); });
    m.def("rectify", rectify, py::arg("rectification").none(true), py::arg("right_eye"), py::arg("image").noconvert(),
          py::arg("out").noconvert());
}

}  // namespace
}  // namespace disparityd::bindings

PYBIND11_MODULE(_matcher, m) {
    py::register_local_exception_translator(disparityd::bindings::translate_with_names);
    disparityd::bindings::add_matching(m);
    disparityd::bindings::add_calibration(m);
}
