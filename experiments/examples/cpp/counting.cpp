// A mapper of your own in C++, with the standard library alone: the share of looks at a cell that hit it.
// Build: c++ -O2 -std=c++17 -o counting counting.cpp
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

// The number behind the first "key" of a JSON text: enough for the files of one sensor; a JSON library is better.
double number(const std::string& json, const std::string& key, int skip = 0) {
    auto at = json.find(':', json.find('"' + key + '"'));
    for (at = json.find_first_of("-0123456789", at); skip > 0; --skip) at = json.find_first_of("-0123456789", json.find(',', at));
    return std::stod(json.substr(at));
}

std::string read(const std::string& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

int main(int count, char** words) {
    const std::string folder = std::string(words[count - 1]) + "/";
    const std::string grid = read(folder + "grid.json"), sensors = read(folder + "sensors.json");
    const double cell = number(grid, "cell_m"), x0 = number(grid, "origin_m"), y0 = number(grid, "origin_m", 1);
    const int width = number(grid, "width"), height = number(grid, "height");
    const double focal_baseline = number(sensors, "focal_baseline"), prior = number(sensors, "occupancy");
    std::vector<float> passed(width * height), hits(width * height);
    std::ifstream scans(folder + "scans.csv");
    std::string line, field;
    std::getline(scans, line);  // scan,time_s,sensor,x_m,y_m,theta_rad,bearing_rad,disparity_px
    while (std::getline(scans, line)) {
        std::vector<double> row;
        for (std::stringstream fields(line); std::getline(fields, field, ',');) row.push_back(std::stod(field));
        if (row.size() < 8) continue;  // no reading
        const double range = focal_baseline / (std::fmax(row[7], 0.1) * std::cos(row[6])), angle = row[5] + row[6];
        const int steps = std::fmin(range, 30.0) / (0.5 * cell);
        for (int step = 0; step <= steps; ++step) {
            const double r = step == steps ? range : 0.5 * cell * step;
            const int i = std::floor((row[3] + r * std::cos(angle) - x0) / cell), j = std::floor((row[4] + r * std::sin(angle) - y0) / cell);
            if (0 <= i && i < width && 0 <= j && j < height) (step == steps ? hits : passed)[j * width + i] += 1;
        }
    }
    std::vector<float> map(width * height, std::numeric_limits<float>::quiet_NaN());
    for (int k = 0; k < width * height; ++k)
        if (hits[k] + passed[k] > 0) map[k] = (hits[k] + prior) / (hits[k] + 0.5 * passed[k] + 1);
    std::string head = "{'descr': '<f4', 'fortran_order': False, 'shape': (" + std::to_string(height) + ", " + std::to_string(width) + "), }";
    head.resize(117, ' ');
    std::ofstream out(folder + "occupancy.npy", std::ios::binary);
    out.write("\x93NUMPY\x01\x00\x76\x00", 10) << head << '\n';
    out.write(reinterpret_cast<const char*>(map.data()), 4 * map.size());
    return out.good() ? 0 : 1;
}
