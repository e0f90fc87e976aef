// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/more_outputs.h"

#include <sstream>

#include "tools/ctl/processing/digest.h"
#include "tools/images/image_file.h"
#include "tools/images/picture.h"
#include "tools/images/point_file.h"

namespace disparityd::tools {

void write_more(const MoreOutputs& outputs, const FrameCopy& frame, DisparityRange range, const std::string& path,
                const std::string& name, Json& digests) {
    const FrameView& view = frame.view();
    const auto write = [&](bool wanted, const char* ending, const auto& picture) {
        if (wanted) {
            const cv::Mat pixels = picture();
            images::write_png(path + ending, pixels);
            digests[name + ending] = sha256(pixels);
        }
    };
    const auto eye = [](const auto& grey, const auto& colour) {
        return colour ? images::colour_view(colour) : images::grey_view(grey);
    };
    write(outputs.depth, "_depth.png", [&] { return images::depth_view(view.depth); });
    write(outputs.depth_error, "_depth_error.png", [&] { return images::depth_view(view.depth_error); });
    write(outputs.confidence, "_confidence.png", [&] { return images::grey_view(view.confidence); });
    write(outputs.rectified, "_left.png", [&] { return eye(view.left, view.left_colour); });
    write(outputs.rectified, "_right.png", [&] { return eye(view.right, view.right_colour); });
    if (!outputs.points.empty()) {
        const calibration::Rectification& used = frame.rectification();
        const images::PointCamera camera{{used.f, used.baseline_mm, used.disparity_offset}, used.cx, used.cy};
        const std::string bytes =
            images::point_file(outputs.points, {view.disparity, range}, camera, eye(view.left, view.left_colour));
        images::write_file(path + '.' + outputs.points, bytes);
        digests[name + '.' + outputs.points] = sha256(bytes);
    }
}

void describe_more(const MoreOutputs& outputs, Json& files) {
    const auto add = [&files](bool wanted, const std::string& name, const std::string& content) {
        if (wanted) {
            files.push_back({{"name", std::string("OUTPUT").append(name)}, {"content", content}});
        }
    };
    add(outputs.depth, "_depth.png", "16-bit PNG, depth in mm, 0 = unknown, 65535 = farther");
    add(outputs.depth_error, "_depth_error.png", "16-bit PNG, one sigma of the depth in mm, 0 = unknown, 65535 = more");
    add(outputs.confidence, "_confidence.png", "8-bit PNG, 0 = rejected");
    add(outputs.rectified, "_left.png", "rectified left image, as it was matched; calib.txt has its camera");
    add(outputs.rectified, "_right.png", "rectified right image");
    add(!outputs.points.empty(), std::string(".").append(outputs.points),
        "points in metres, of the left camera: x right, y down, z ahead; with colours");
}

std::string middlebury_calibration(const calibration::Rectification& rectified, DisparityRange range) {
    std::ostringstream text;
    text.precision(17);
    const auto camera = [&](int number, double cx) {
        text << "cam" << number << "=[" << rectified.f << " 0 " << cx << "; 0 " << rectified.f << ' ' << rectified.cy
             << "; 0 0 1]\n";
    };
    camera(0, rectified.cx);
    camera(1, rectified.cx + rectified.disparity_offset);
    text << "doffs=" << rectified.disparity_offset << "\nbaseline=" << rectified.baseline_mm
         << "\nwidth=" << rectified.width << "\nheight=" << rectified.height << "\nndisp=" << range.first + range.count
         << '\n';
    return text.str();
}

}  // namespace disparityd::tools
