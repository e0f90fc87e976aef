// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace disparityd::capture {

/// Millimetres in the left camera's axes (x right, y down, z forward).
struct Vec3 {
    double x = 0;
    double y = 0;
    double z = 0;

    friend Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vec3 operator*(double s, Vec3 v) { return {s * v.x, s * v.y, s * v.z}; }
};
inline double dot(Vec3 a, Vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

struct Ray {
    Vec3 origin;
    Vec3 direction;  ///< any length
};

/// The rendered 3-D scene at one moment: slanted ground and wall, boxes, balls, poles and wires, some of them moving on
/// closed courses. Only additions, multiplications, divisions and square roots decide what is seen, so it is the same
/// on every machine.
class SceneWorld {
public:
    /// `phase` in [0, 1) is the moment of the loop.
    SceneWorld(double phase, std::uint32_t seed);

    struct Hit {
        double distance = 0;  ///< in lengths of the ray's direction
        int object = -1;
        Vec3 normal;
    };

    /// The nearest surface; every ray that looks ahead hits something.
    Hit cast(const Ray& ray) const;

    /// Whether that is a pole or a wire.
    bool is_rod(const Hit& hit) const;

    /// What a camera sees there: luma 0 .. 255 and chroma around 128.
    struct Colour {
        double luma;
        double u;
        double v;
    };
    /// `footprint` is the size of a pixel on the surface in mm: finer texture is left out.
    Colour colour(const Ray& ray, const Hit& hit, double footprint) const;

private:
    enum class Shape : std::uint8_t { plane, ball, box, rod };
    struct Object {
        Shape shape = Shape::plane;
        Vec3 centre;          // of the plane: a point on it
        Vec3 axis;            // plane: its normal; rod: from the middle to an end
        Vec3 half_size;       // box; ball and rod: x is the radius
        double turn_cos = 1;  // box: about y
        double turn_sin = 0;
        double bound = 0;  // radius of a ball around it, squared
        double luma = 128;
        double contrast = 60;
        double u = 128;
        double v = 128;
        double grain = 400;  // largest texture wavelength, mm
    };

    void add_plane(Vec3 point, Vec3 normal, Object look);
    void add_ball(Vec3 centre, double radius, Object look);
    void add_box(Vec3 centre, Vec3 half_size, double half_turn_tangent, Object look);
    void add_rod(Vec3 from, Vec3 to, double radius, Object look);

    static bool hits_ball(const Object& object, const Ray& ray, Hit& hit);
    static bool hits_box(const Object& object, const Ray& ray, Hit& hit);
    static bool hits_rod(const Object& object, const Ray& ray, Hit& hit);
    static Vec3 to_box(const Object& object, Vec3 v);

    std::uint32_t seed_;
    std::vector<Object> planes_;
    std::vector<Object> objects_;
};

}  // namespace disparityd::capture
