// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/conditions/condition.h"
#include "tools/eval/conditions/frame_conditions.h"
#include "tools/eval/conditions/light_conditions.h"
#include "tools/eval/conditions/scene_conditions.h"

namespace disparityd::eval {
namespace {

constexpr std::array all{
    Condition{"noise", "sensor", "grey levels", {{{2, 3}, {3.5, 5}, {6, 8}}}, add_noise, true},
    Condition{"shared noise", "sensor", "grey levels", {{{1.5, 2.5}, {3, 4}, {5, 7}}}, add_shared_noise, true},
    Condition{"low light", "sensor", "% of the light", {{{40, 50}, {20, 30}, {8, 14}}}, dim},
    Condition{"overexposure", "sensor", "% of the exposure", {{{150, 180}, {200, 260}, {320, 420}}}, overexpose},
    Condition{"underexposure", "sensor", "% of the exposure", {{{50, 60}, {30, 40}, {15, 20}}}, underexpose},
    Condition{"unequal eyes", "sensor", "% of the other's light", {{{75, 90}, {50, 60}, {25, 35}}}, expose_unequally},
    Condition{"motion blur", "optics", "px", {{{2, 3}, {5, 7}, {10, 14}}}, blur_motion, true},
    Condition{"glare", "optics", "grey levels", {{{30, 60}, {100, 150}, {200, 300}}}, add_glare},
    Condition{"flare", "optics", "grey levels", {{{15, 30}, {40, 70}, {90, 140}}}, add_flare},
    Condition{"vignetting", "optics", "% lost in corners", {{{20, 30}, {45, 55}, {70, 85}}}, darken_corners},
    Condition{"drop on one lens", "optics", "px radius", {{{15, 25}, {40, 60}, {90, 130}}}, drop_on_one},
    Condition{"dirt on one lens", "optics", "% of it", {{{2, 4}, {8, 12}, {20, 30}}}, dirt_on_one},
    Condition{"covered eye", "optics", "% of its width", {{{15, 25}, {40, 60}, {100, 100}}}, cover_one},
    Condition{"rain", "weather", "drops", {{{150, 250}, {500, 700}, {1500, 2000}}}, rain_in_both},
    Condition{"rain in one eye", "weather", "drops", {{{150, 250}, {500, 700}, {1500, 2000}}}, rain_in_one},
    Condition{"dust", "weather", "grains", {{{20, 40}, {80, 120}, {250, 350}}}, dust_in_both},
    Condition{"dust in one eye", "weather", "grains", {{{20, 40}, {80, 120}, {250, 350}}}, dust_in_one},
    Condition{"JPEG", "frames", "quality", {{{70, 85}, {35, 50}, {10, 20}}}, compress, true},
    Condition{"lost blocks", "frames", "degrees", {{{0.1, 0.3}, {0.6, 1}, {1.5, 2.5}}}, lose_blocks, true},
    Condition{"one eye torn", "frames", "degrees", {{{0.1, 0.3}, {0.6, 1}, {1.5, 2.5}}}, tear_one, true},
    Condition{"both eyes torn", "frames", "degrees", {{{0.1, 0.3}, {0.6, 1}, {1.5, 2.5}}}, tear_both, true},
    Condition{"eyes of two instants", "frames", "degrees", {{{0.02, 0.05}, {0.1, 0.2}, {0.4, 0.8}}}, look_later, true},
    Condition{"rows off", "frames", "px", {{{0.2, 0.3}, {0.45, 0.6}, {0.9, 1}}}, lift_rows, true},
    Condition{"focal length off", "frames", "%", {{{0.1, 0.15}, {0.25, 0.3}, {0.45, 0.5}}}, change_focal, true},
    Condition{"fence", "texture", "m wide", {{{0.4, 0.6}, {0.8, 1.2}, {1.8, 2.4}}}, add_fence},
    Condition{"tiles", "texture", "% repeated", {{{30, 40}, {60, 70}, {95, 100}}}, tile_ground},
    Condition{"level blinds", "texture", "% repeated", {{{30, 40}, {60, 70}, {95, 100}}}, add_level_blinds},
    Condition{"upright blinds", "texture", "% repeated", {{{30, 40}, {60, 70}, {95, 100}}}, add_upright_blinds},
    Condition{"chessboard", "texture", "% repeated", {{{30, 40}, {60, 70}, {95, 100}}}, add_chessboard},
    Condition{"plain walls", "texture", "grey levels", {{{6, 10}, {2, 4}, {0, 0.5}}}, add_plain_wall},
    Condition{"glass", "texture", "% clear", {{{50, 60}, {80, 88}, {95, 99}}}, add_glass},
    Condition{"mirror", "texture", "% reflected", {{{40, 50}, {70, 80}, {96, 100}}}, add_mirror},
    Condition{"nearer than the range", "things", "m", {{{0.56, 0.64}, {0.42, 0.55}, {0.25, 0.38}}}, add_near_thing},
    Condition{"level wires", "things", "mm", {{{24, 30}, {16, 20}, {8, 12}}}, add_level_wires},
    Condition{"slanted wires", "things", "mm", {{{24, 30}, {16, 20}, {8, 12}}}, add_slanted_wires},
    Condition{"pole behind pole", "things", "degrees apart", {{{3, 4}, {1.8, 2.2}, {1, 1.2}}}, add_pole_pairs},
    Condition{"overhang", "things", "m thick", {{{0.25, 0.3}, {0.1, 0.14}, {0.03, 0.05}}}, add_overhang},
    Condition{"step down", "things", "m deep", {{{0.3, 0.4}, {0.15, 0.2}, {0.08, 0.12}}}, add_step_down},
    Condition{"hole", "things", "m wide", {{{0.8, 1}, {0.4, 0.5}, {0.2, 0.25}}}, add_hole},
};

}  // namespace

std::span<const Condition> conditions() {
    return all;
}

}  // namespace disparityd::eval
