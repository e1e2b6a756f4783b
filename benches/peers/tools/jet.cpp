// CGAL's jet fitting at the contacts nearest to the targets: principal curvatures by a polynomial over k neighbours.
//
//     jet CONTACTS.csv TARGETS.csv NEIGHBOURS REPETITIONS        prints "T seconds", then x, y, k1, k2 a line
#include <CGAL/Monge_via_jet_fitting.h>
#include <CGAL/Orthogonal_k_neighbor_search.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Search_traits_adapter.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Vector = Kernel::Vector_3;
using Contact = std::tuple<Point, Vector>;
using Traits = CGAL::Search_traits_adapter<Contact, CGAL::Nth_of_tuple_property_map<0, Contact>, CGAL::Search_traits_3<Kernel>>;
using Search = CGAL::Orthogonal_k_neighbor_search<Traits>;
using Jet = CGAL::Monge_via_jet_fitting<Kernel>;

static std::vector<std::vector<double>> read(const char *path) {
    std::ifstream in(path);
    std::vector<std::vector<double>> rows;
    std::string line, field;
    std::getline(in, line);
    while (std::getline(in, line)) {
        std::stringstream fields(line);
        rows.emplace_back();
        while (std::getline(fields, field, ',')) rows.back().push_back(std::stod(field));
    }
    return rows;
}

int main(int, char **arguments) {
    std::vector<Contact> contacts;
    for (auto &r : read(arguments[1])) contacts.emplace_back(Point(r[0], r[1], r[2]), Vector(r[3], r[4], r[5]));
    auto targets = read(arguments[2]);
    const unsigned neighbours = std::stoul(arguments[3]);
    std::vector<std::array<double, 4>> answers;
    for (int repetition = 0; repetition < std::stoi(arguments[4]); ++repetition) {
        answers.clear();
        auto start = std::chrono::steady_clock::now();
        Search::Tree tree(contacts.begin(), contacts.end());
        for (auto &t : targets) {
            Search nearest(tree, Point(t[0], t[1], t[2]), 1);
            auto [at, normal] = (*nearest.begin()).first;
            std::vector<Point> near;
            Search around(tree, at, neighbours);
            for (auto found : around) near.push_back(std::get<0>(found.first));
            auto monge = Jet()(near.begin(), near.end(), 2, 2);
            monge.comply_wrt_given_normal(normal);
            answers.push_back({at.x(), at.y(), monge.principal_curvatures(0), monge.principal_curvatures(1)});
        }
        std::printf("T %.9g\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    for (auto &a : answers) std::printf("%.17g,%.17g,%.17g,%.17g\n", a[0], a[1], a[2], a[3]);
}
