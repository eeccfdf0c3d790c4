// Surfaces of points by CGAL, for comparison: cgal_surfaces advancing|scale POINTS.f64 MESH.off
//
// Points are raw little-endian triples of doubles. For scale space the points are smoothed four
// times, as its manual has it, the surface passes through the points as they were.

#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <CGAL/Advancing_front_surface_reconstruction.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Scale_space_reconstruction_3/Advancing_front_mesher.h>
#include <CGAL/Scale_space_reconstruction_3/Weighted_PCA_smoother.h>
#include <CGAL/Scale_space_surface_reconstruction_3.h>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Facet = std::array<std::size_t, 3>;

int main(int count, char** words) {
    if (count != 4) return 2;
    std::ifstream in(words[2], std::ios::binary);
    std::vector<Point> points;
    for (double p[3]; in.read(reinterpret_cast<char*>(p), sizeof p);) points.emplace_back(p[0], p[1], p[2]);
    std::vector<Facet> facets;
    if (std::string(words[1]) == "advancing") {
        CGAL::advancing_front_surface_reconstruction(points.begin(), points.end(), std::back_inserter(facets));
    } else {
        CGAL::Scale_space_surface_reconstruction_3<Kernel> scale(points.begin(), points.end());
        scale.increase_scale(4, CGAL::Scale_space_reconstruction_3::Weighted_PCA_smoother<Kernel>());
        scale.reconstruct_surface(CGAL::Scale_space_reconstruction_3::Advancing_front_mesher<Kernel>());
        for (auto f = scale.facets_begin(); f != scale.facets_end(); ++f) facets.push_back({(*f)[0], (*f)[1], (*f)[2]});
    }
    std::FILE* out = std::fopen(words[3], "w");
    if (!out) return 1;
    std::fprintf(out, "OFF\n%zu %zu 0\n", points.size(), facets.size());
    for (const Point& p : points) std::fprintf(out, "%.17g %.17g %.17g\n", p.x(), p.y(), p.z());
    for (const Facet& f : facets) std::fprintf(out, "3 %zu %zu %zu\n", f[0], f[1], f[2]);
    return std::fclose(out) == 0 ? 0 : 1;
}
