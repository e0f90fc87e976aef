// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/conditions/scene_conditions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace disparityd::eval {
namespace {

using Kind = Surface::Kind;

/// A look that repeats, by so many per cent.
Surface repeated(CourseMaker& m, Kind kind, double period_m, double share) {
    const double luma = m.between(90, 150);
    return {kind, luma, m.between(40, 70), period_m, share / 100};
}

/// An upright panel across the way.
void add_panel(CourseMaker& m, double metres, double half_wide, double half_high, const Surface& surface) {
    const double side = metres * m.between(-0.35, 0.35);
    m.course.obstacles.push_back(
        {Obstacle::Shape::box, {metres, side, half_high}, {0.02, half_wide, half_high}, surface});
}

void add_repeated_panel(CourseMaker& m, Kind kind, double share) {
    const double metres = m.between(1.2, 3);
    const double period = m.between(0.03, 0.08);
    const double half_wide = m.between(0.3, 0.6);
    add_panel(m, metres, half_wide, 0.4, repeated(m, kind, period, share));
}

Surface plain(double luma) {
    return {Kind::plain, luma, 0, 1};
}

}  // namespace

void add_fence(CourseMaker& m, double metres) {
    const Point middle = m.place(m.between(1.2, 2.5));
    const double step = m.between(0.08, 0.14);
    const double radius = m.between(0.012, 0.02);
    const Surface bars = plain(m.between(40, 200));
    const int count = std::max(2, static_cast<int>(std::lround(metres / step)) + 1);
    for (int i = 0; i < count; ++i) {
        m.add_post({middle.x, middle.y + (i - (count - 1) / 2.0) * step, 0}, radius, 0.9, bars);
    }
}

void tile_ground(CourseMaker& m, double share) {
    const double side = m.between(0.1, 0.3);
    m.course.ground = repeated(m, Kind::tiled, side, share);
}

void add_level_blinds(CourseMaker& m, double share) {
    add_repeated_panel(m, Kind::blinds, share);
}

void add_upright_blinds(CourseMaker& m, double share) {
    add_repeated_panel(m, Kind::striped, share);
}

void add_chessboard(CourseMaker& m, double share) {
    add_repeated_panel(m, Kind::chequered, share);
}

void add_plain_wall(CourseMaker& m, double contrast) {
    const double metres = m.between(1.2, 2.5);
    const double luma = m.between(100, 210);
    const Surface surface{Kind::rough, luma, contrast, 0.04};
    add_panel(m, metres, 0.6, 0.6, surface);
    m.course.wall.contrast = contrast;
}

void add_glass(CourseMaker& m, double share) {
    Surface pane = m.rough();
    pane.kind = Kind::glass;
    pane.share = share / 100;
    add_panel(m, m.between(1.2, 2.5), 0.5, 0.6, pane);
}

void add_mirror(CourseMaker& m, double share) {
    Surface mirror = m.rough();
    mirror.kind = Kind::mirror;
    mirror.share = share / 100;
    add_panel(m, m.between(1.2, 2.5), 0.5, 0.6, mirror);
}

void add_near_thing(CourseMaker& m, double metres) {
    constexpr std::array kinds{Kind::rough, Kind::plain, Kind::striped, Kind::chequered, Kind::blinds};
    const auto kind = static_cast<std::size_t>(m.between(0, kinds.size()));
    Surface surface = repeated(m, kinds[kind], m.between(0.02, 0.06), 100);
    surface.contrast = kinds[kind] == Kind::plain ? 0 : surface.contrast;
    const double side = m.between(-0.1, 0.1);
    m.course.obstacles.push_back({Obstacle::Shape::box, {metres + 0.03, side, 0.3}, {0.03, 0.15, 0.3}, surface});
}

void add_level_wires(CourseMaker& m, double thickness) {
    for (int i = 0; i < 2; ++i) {
        const double metres = m.between(0.8, 1.5);
        const double height = m.between(0.2, 0.8);
        m.add_wire({metres, 0, 0}, height, thickness / 2000, m.rough());
    }
}

void add_slanted_wires(CourseMaker& m, double thickness) {
    for (int i = 0; i < 3; ++i) {
        const Point at = m.place(m.between(0.8, 1.5));
        const double angle = m.between(15, 60) * std::numbers::pi / 180;
        const double up = m.between(0, 1) < 0.5 ? -1 : 1;
        m.course.obstacles.push_back({Obstacle::Shape::bar,
                                      {at.x, at.y, 0.5},
                                      {thickness / 2000, 0.5 * std::cos(angle), up * 0.5 * std::sin(angle)},
                                      m.rough()});
    }
}

void add_pole_pairs(CourseMaker& m, double degrees) {
    for (int i = 0; i < 2; ++i) {
        const double metres = m.between(1, 2);
        const double bearing = m.between(-0.5, 0.5);
        const double behind = metres + m.between(0.5, 1.5);
        const double turn = degrees * std::numbers::pi / 180;
        m.add_post({metres * std::cos(bearing), metres * std::sin(bearing), 0}, 0.02, 1.2, m.rough());
        m.add_post({behind * std::cos(bearing + turn), behind * std::sin(bearing + turn), 0}, 0.03, 1.2, m.rough());
    }
}

void add_overhang(CourseMaker& m, double thickness) {
    const Point at = m.place(m.between(1.2, 3));
    const double height = m.between(0.45, 0.75);
    const Surface surface = m.rough();
    m.course.obstacles.push_back({Obstacle::Shape::box, {at.x, at.y, height}, {0.25, 0.4, thickness / 2}, surface});
}

void add_step_down(CourseMaker& m, double depth) {
    const double edge = m.between(1, 2.5);
    for (Obstacle& obstacle : m.course.obstacles) {
        obstacle.centre.z -= obstacle.centre.x > edge ? depth : 0;
    }
    constexpr double far = 50;
    m.course.obstacles.push_back(
        {Obstacle::Shape::hole, {edge + far, 0, -depth / 2}, {far, far, depth / 2}, m.course.ground});
}

void add_hole(CourseMaker& m, double side) {
    const Point edge = m.place(m.between(0.8, 1.5));
    constexpr double depth = 0.3;
    // Little light falls in.
    Surface inside = m.course.ground;
    inside.luma *= 0.6;
    m.course.obstacles.push_back(
        {Obstacle::Shape::hole, {edge.x + side / 2, edge.y, -depth / 2}, {side / 2, side / 2, depth / 2}, inside});
}

}  // namespace disparityd::eval
