// Inside a loop over the pairs of a bin, a lane each: with subgroups every lane holds the splat of its pair, and `todo`
// has the lanes whose splats reach the patch; without, splats are fetched when it is their turn.
//: if SUBGROUPS
        var g0 = vec4f(0.0);
        var g1 = vec4f(0.0);
        var g2 = vec4f(0.0);
//: for q in QUADS
        var mine$q = vec4f(0.0);
//: end
        if (is_reached) {
            g0 = textureLoad(geometry, texel(GEOMETRY_QUADS * pair.x), 0);
            g1 = textureLoad(geometry, texel(GEOMETRY_QUADS * pair.x + 1u), 0);
            g2 = textureLoad(geometry, texel(GEOMETRY_QUADS * pair.x + 2u), 0);
//: for q in QUADS
            mine$q = textureLoad(features, texel(N_QUADS * pair.x + $qu), 0);
//: end
        }
        var todo = vote(is_reached);
//: else
        var todo = vote(is_reached, lane);
//: end
