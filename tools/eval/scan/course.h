// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// Made-up courses of obstacles for a robot, of which everything is known. Lengths in metres, in the robot's frame: x
/// ahead, y left, z up, the origin on the ground below the camera.
namespace disparityd::eval {

struct Point {
    double x = 0;
    double y = 0;
    double z = 0;

    friend Point operator+(Point a, Point b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Point operator*(double s, Point p) { return {s * p.x, s * p.y, s * p.z}; }
    friend bool operator==(Point, Point) = default;
};

/// What a surface looks like.
struct Surface {
    /// striped: upright stripes; blinds: level ones; tiled: dark joints of a ground; a mirror and glass face along x.
    enum class Kind : std::uint8_t { rough, plain, striped, blinds, chequered, tiled, mirror, glass };
    Kind kind = Kind::rough;
    double luma = 120;
    double contrast = 60;
    double grain_m = 0.03;  ///< of the coarsest structure; the period of what repeats
    double share = 1;       ///< 0 .. 1: how much the kind is seen; the rest is rough

    friend bool operator==(const Surface&, const Surface&) = default;
};

/// An upright box or cylinder, a wire across the way, a straight bar from its lower right to its upper left end, or a
/// hole in level ground.
struct Obstacle {
    enum class Shape : std::uint8_t { box, post, wire, bar, hole };
    Shape shape = Shape::box;
    Point centre;
    /// box and hole: half its sizes; post: x the radius, z half the height; wire: x the radius, y half its length; bar:
    /// x the radius, y and z from the centre to its upper left end.
    Point half;
    Surface surface;

    friend bool operator==(const Obstacle&, const Obstacle&) = default;
};

struct Course {
    std::string kind;  ///< "pole", "slope": what the table names it
    std::string name;
    std::vector<Obstacle> obstacles;
    Surface ground;
    Surface wall;            ///< far ahead
    double wall_m = 14;      ///< its distance
    double slope_ahead = 0;  ///< of the ground
    double slope_left = 0;
    double pitch_deg = 0;  ///< of the camera beyond what the scan is told
    double roll_deg = 0;
    double noise = 1.5;  ///< sigma, grey levels
    double light = 1;    ///< factor of all lumas
    std::uint32_t seed = 0;
    bool sequel = false;  ///< the next frame of the course before
};

/// The camera of a course: rectified, looking along x but for Course::pitch_deg and roll_deg.
struct CourseCamera {
    int width = 640;
    int height = 480;
    double f = 350;
    double baseline_m = 0.12;
    double height_m = 0.3;
    /// Where the robot has gone since the course began: to (x_m, y_m), and turned left by so much.
    double x_m = 0;
    double y_m = 0;
    double yaw_deg = 0;
    int rays = 2;  ///< per pixel and side, 1 or more: with 2, edges of thin objects are grey, as a camera's are
};

/// How an eye stands apart from where its calibration has it, or from where it is when the frame is taken.
struct EyeError {
    double ahead_m = 0;  ///< the robot has gone so far since
    double yaw_deg = 0;  ///< and has turned left so far
    double rows = 0;     ///< what it sees lies so many rows higher in the image
    double focal = 1;    ///< factor of the focal length
};

/// Courses of every kind, `count` of each; those of the last kind are some frames long, one Course each. Other seeds
/// give other courses.
std::vector<Course> make_courses(std::uint32_t seed, int count);

/// Courses with a box, a post, a thin pole and a farther box each, on which conditions are tried.
std::vector<Course> make_base_courses(std::uint32_t seed, int count);

/// What the left camera sees: for each pixel the nearest surface.
struct CourseView {
    std::vector<std::uint8_t> left;
    std::vector<std::uint8_t> right;
    std::vector<std::int16_t> object;  ///< index of Course::obstacles; -1 ground, -2 wall, -3 nothing
    std::vector<Point> point;          ///< in the robot's frame; of a hole, its edge in that direction
    std::vector<std::uint8_t> both;    ///< 1 where the right camera sees the point, too
};

/// Draws a course. The same everywhere but for the last digits of floating point.
CourseView draw(const Course& course, const CourseCamera& camera);

/// Fills in what is known of each pixel of the left image: all but the images.
void add_truth(const Course& course, const CourseCamera& camera, CourseView& view);

/// How far ahead of the left camera the nearest surface of each pixel is, along its axis; infinite where nothing is.
std::vector<double> draw_depth(const Course& course, const CourseCamera& camera);

/// What arrives at one eye's sensor, row by row: grey levels without noise, light or limits.
std::vector<double> draw_luma(const Course& course, const CourseCamera& camera, bool right, const EyeError& error);

/// Draws the obstacles from `first_added` on over what draw_luma() gave of the course without them: the same as all of
/// it anew, and sooner.
void draw_added(const Course& course, const CourseCamera& camera, bool right, std::size_t first_added,
                std::vector<double>& luma);

}  // namespace disparityd::eval
