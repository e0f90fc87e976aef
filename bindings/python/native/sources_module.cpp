// SPDX-License-Identifier: Apache-2.0
// The Python module disparity_matcher._sources: frames of any source. Apart from _matcher, which then loads no
// decoders.
#include <chrono>
#include <cstdint>
#include <cstring>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "bindings/python/native/file_names.h"
#include "calibration/calibration_lookup.h"
#include "capture/frame_source.h"
#include "capture/pixel_format.h"

namespace py = pybind11;

namespace disparityd::bindings {
namespace {

using capture::FrameSource;
using capture::RawFrame;
using Bytes = py::array_t<std::uint8_t>;

/// A frame on loan, given back at the end of the scope.
class BorrowedFrame {
public:
    explicit BorrowedFrame(FrameSource& source) : source_(source) {}
    ~BorrowedFrame() {
        if (held_) {
            source_.give_back(frame_);
        }
    }
    BorrowedFrame(const BorrowedFrame&) = delete;
    BorrowedFrame& operator=(const BorrowedFrame&) = delete;

    FrameSource::Next wait(std::chrono::milliseconds time) {
        const auto got = source_.next(frame_, std::chrono::steady_clock::now() + time);
        held_ = got == FrameSource::Next::frame;
        return got;
    }
    const RawFrame& frame() const { return frame_; }

private:
    FrameSource& source_;
    RawFrame frame_;
    bool held_ = false;
};

/// An open source. One thread at a time waits for a frame; close() ends its wait.
class PythonSource {
public:
    PythonSource(const std::string& uri, const std::string& calibration, bool fastest, bool loop, bool skip_damaged);

    /// The next frame as a tuple (package's Frame has the names), or None after the last one.
    py::object next();
    void close();
    /// What was reported since the last call.
    std::vector<py::str> take_notes();
    const capture::SourceInfo& info() const { return info_; }
    std::optional<std::string> calibration_text() const;

private:
    py::tuple made(const RawFrame& frame);

    std::mutex notes_mutex_;
    std::vector<std::string> notes_;
    std::mutex mutex_;  // the source while somebody waits for a frame
    std::unique_ptr<FrameSource> source_;
    bool closed_ = false;  // changed and read with Python's lock held
    capture::SourceInfo info_;
};

PythonSource::PythonSource(const std::string& uri, const std::string& calibration, bool fastest, bool loop,
                           bool skip_damaged) {
    capture::SourceOptions options;
    options.uri = uri;
    options.calibration_path = calibration;
    options.pace = fastest ? capture::Pace::fastest : capture::Pace::source;
    options.loop = loop;
    options.skip_damaged = skip_damaged;
    options.calibration_folders = calibration::folder_list(calibration::standard_calibration_folders);
    options.report = [this](const std::string& line, bool) {
        const std::lock_guard lock(notes_mutex_);
        notes_.push_back(line);
    };
    const py::gil_scoped_release others_run;
    source_ = capture::open_source(options);
    info_ = source_->info();
}

std::optional<std::string> PythonSource::calibration_text() const {
    return info_.calibration ? std::optional(calibration::to_text(*info_.calibration)) : std::nullopt;
}

std::vector<py::str> PythonSource::take_notes() {
    std::vector<std::string> taken;
    {
        const std::lock_guard lock(notes_mutex_);
        taken.swap(notes_);
    }
    std::vector<py::str> notes;
    notes.reserve(taken.size());
    for (const std::string& note : taken) {
        notes.push_back(text_with_names(note));
    }
    return notes;
}

py::object PythonSource::next() {
    if (closed_) {
        throw py::value_error("the source is closed");
    }
    for (;;) {
        // In this order, so that nobody waits for the one while holding the other.
        auto released = std::make_optional<py::gil_scoped_release>();
        const std::lock_guard lock(mutex_);
        if (!source_) {  // closed while this waited
            released.reset();
            return py::none();
        }
        BorrowedFrame borrowed(*source_);
        constexpr std::chrono::milliseconds until_signals{100};
        const auto got = borrowed.wait(until_signals);
        released.reset();
        if (PyErr_CheckSignals() != 0) {
            throw py::error_already_set();
        }
        switch (got) {
            case FrameSource::Next::frame: return made(borrowed.frame());
            case FrameSource::Next::timeout: continue;
            case FrameSource::Next::end:
            case FrameSource::Next::interrupted: return py::none();
        }
    }
}

py::tuple PythonSource::made(const RawFrame& frame) {
    const RawImage& image = frame.image;
    const int row_bytes = 2 * image.eye_width * bytes_per_pixel(image.format);
    Bytes pixels({image.height, row_bytes});
    std::uint8_t* to = pixels.mutable_data();
    {
        const py::gil_scoped_release others_run;
        for (int y = 0; y < image.height; ++y) {
            std::memcpy(to + static_cast<std::ptrdiff_t>(y) * row_bytes, image.data + y * image.stride,
                        static_cast<std::size_t>(row_bytes));
        }
    }
    std::optional<std::string> corrected;
    if (frame.correction.any() && info_.calibration) {
        corrected = calibration::to_text(calibration::corrected(*info_.calibration, frame.correction));
    }
    return py::make_tuple(pixels, std::string(capture::to_string(image.format)), frame.sequence, frame.monotonic_ns,
                          frame.realtime_ns, frame.dropped_before, (frame.flags & capture::frame_flag_corrupt) != 0,
                          (frame.flags & capture::frame_flag_discontinuity) != 0, text_with_names(frame.name),
                          corrected);
}

void PythonSource::close() {
    if (!std::exchange(closed_, true)) {
        const py::gil_scoped_release others_run;
        source_->interrupt();
        const std::lock_guard lock(mutex_);
        source_.reset();
    }
}

}  // namespace
}  // namespace disparityd::bindings

PYBIND11_MODULE(_sources, m) {
    using disparityd::bindings::PythonSource;
    using disparityd::bindings::text_with_names;
    py::register_local_exception_translator(disparityd::bindings::translate_with_names);
    py::class_<PythonSource>(m, "Source")
        .def(py::init<const std::string&, const std::string&, bool, bool, bool>(), py::arg("uri"),
             py::arg("calibration"), py::arg("fastest"), py::arg("loop"), py::arg("skip_damaged"))
        .def("next", &PythonSource::next)
        .def("close", &PythonSource::close)
        .def("take_notes", &PythonSource::take_notes)
        .def_property_readonly("calibration_text", &PythonSource::calibration_text)
        .def_property_readonly("name", [](const PythonSource& of) { return text_with_names(of.info().name); })
        .def_property_readonly("description",
                               [](const PythonSource& of) { return text_with_names(of.info().description); })
        .def_property_readonly("width", [](const PythonSource& of) { return of.info().eye_width; })
        .def_property_readonly("height", [](const PythonSource& of) { return of.info().height; })
        .def_property_readonly("rate", [](const PythonSource& of) { return of.info().rate; })
        .def_property_readonly("live", [](const PythonSource& of) { return of.info().live; })
        .def_property_readonly("synthetic", [](const PythonSource& of) { return of.info().synthetic; })
        .def_property_readonly("frame_count", [](const PythonSource& of) { return of.info().frame_count; });
}
