#include "tools/racing/grid_race_result.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "json/json.hpp"
#include "tools/command_line/words.hpp"

namespace slalom::tools {
namespace {

using evaluation::CarEnd;
using evaluation::CarResult;
using evaluation::ContactRate;
using evaluation::GridRaceResult;

/// A car over several races. Places and ends are those of races that were not interrupted.
struct CarSummary {
  int races = 0, wins = 0, places = 0;
  int finished = 0, walls = 0, timeouts = 0, overtakes = 0, overtaken = 0;
  double best_lap = std::numeric_limits<double>::quiet_NaN();
  ContactRate contacts;
};

CarSummary car_summary(const GridRaces& races, int entry) {
  CarSummary summary;
  summary.contacts = evaluation::contact_rate(races.results, entry);
  for (const GridRaceResult& race : races.results) {
    const CarResult& car = race.cars[static_cast<std::size_t>(entry)];
    summary.best_lap = std::fmin(summary.best_lap, car.best_lap());
    summary.overtakes += car.overtakes;
    summary.overtaken += car.overtaken;
    if (race.cancelled) continue;
    ++summary.races;
    summary.places += car.place + 1;
    summary.wins += car.place == 0 && car.end == CarEnd::finished;
    summary.finished += car.end == CarEnd::finished;
    summary.walls += car.end == CarEnd::wall;
    summary.timeouts += car.end == CarEnd::timeout;
  }
  return summary;
}

/// A number with so many decimals; "-" if it is not finite.
std::string number_text(double value, int digits) {
  return std::isfinite(value) ? formatted("%.*f", digits, value) : "-";
}

/// Describes how a race ended for a car.
std::string end_text(const CarResult& car) {
  if (car.end == CarEnd::wall) return car.contact_before ? "out: wall, after a contact" : "out: wall";
  return car.end == CarEnd::finished ? "" : std::string(evaluation::name(car.end));
}

int widest(const std::vector<std::string>& names) {
  std::size_t width = 8;
  for (const std::string& name : names) width = std::max(width, name.size());
  return static_cast<int>(width);
}

std::string contacts_text(const ContactRate& rate) {
  if (rate.kilometres <= 0) return "-";
  return formatted("%.1f (%.1f to %.1f)", rate.per_100_km, rate.interval.low, rate.interval.high);
}

Json rate_json(const ContactRate& rate) {
  return {{"contacts", rate.contacts},
          {"contacts_caused", rate.caused},
          {"distance_km", rate.kilometres},
          {"caused_per_100_km", rate.per_100_km},
          {"caused_per_100_km_ci", {rate.interval.low, rate.interval.high}}};
}

Json standing_json(const CarResult& car, const std::string& name) {
  Json json{{"place", car.place + 1},
            {"car", name},
            {"grid_place", car.grid_place + 1},
            {"end", std::string(evaluation::name(car.end))},
            {"laps", static_cast<int>(car.lap_times.size())},
            {"time_s", car.time},
            {"gap_s", car.gap},
            {"best_lap_s", car.best_lap()},
            {"lap_times_s", car.lap_times},
            {"progress_m", car.progress},
            {"distance_m", car.distance},
            {"overtakes", car.overtakes},
            {"overtaken", car.overtaken},
            {"contacts", car.contacts},
            {"contacts_caused", car.caused}};
  if (car.end == CarEnd::wall)
    json["wall"] = {{"pose", {car.last.x, car.last.y, car.last.yaw}}, {"contact_before", car.contact_before}};
  return json;
}

Json one_race_json(const GridRaceResult& race, const std::vector<std::string>& names, int number) {
  const auto name_of = [&](int car) { return names[static_cast<std::size_t>(car)]; };
  Json json{{"race", number},
            {"seed", race.seed},
            {"interrupted", race.cancelled},
            {"time_s", race.time},
            {"standings", Json::array()},
            {"contacts", Json::array()},
            {"overtakes", Json::array()}};
  for (const int car : race.standings)
    json["standings"].push_back(standing_json(race.cars[static_cast<std::size_t>(car)], name_of(car)));
  for (const evaluation::CarContact& contact : race.contacts)
    json["contacts"].push_back({{"time_s", contact.time},
                                {"cars", Json::array({name_of(contact.cars[0]), name_of(contact.cars[1])})},
                                {"at_fault", name_of(contact.at_fault)},
                                {"pose", {contact.pose.x, contact.pose.y, contact.pose.yaw}}});
  for (const evaluation::Overtake& overtake : race.overtakes)
    json["overtakes"].push_back({{"time_s", overtake.time},
                                 {"car", name_of(overtake.car)},
                                 {"overtaken", name_of(overtake.overtaken)}});
  return json;
}

Json summary_json(const CarSummary& summary, const std::string& name) {
  const evaluation::Interval wins = evaluation::wilson_interval(summary.wins, summary.races);
  Json json{{"car", name},
            {"races", summary.races},
            {"wins", summary.wins},
            {"win_rate_ci", {wins.low, wins.high}},
            {"mean_place", static_cast<double>(summary.places) / summary.races},
            {"finished", summary.finished},
            {"walls", summary.walls},
            {"timeouts", summary.timeouts},
            {"best_lap_s", summary.best_lap},
            {"overtakes", summary.overtakes},
            {"overtaken", summary.overtaken}};
  json.update(rate_json(summary.contacts));
  return json;
}

}  // namespace

void print_standings(std::FILE* out, const std::vector<std::string>& names, const GridRaceResult& race) {
  const int width = widest(names);
  std::fprintf(out, "\n%5s  %-*s %5s %5s %10s %9s %12s %9s %9s %9s %7s %10s\n", "place", width, "car", "grid",
               "laps", "time, s", "gap, s", "best lap, s", "overtook", "overtaken", "contacts", "caused",
               "driven, m");
  for (const int entry : race.standings) {
    const CarResult& car = race.cars[static_cast<std::size_t>(entry)];
    std::fprintf(out, "%5d  %-*s %5d %5zu %10.3f %9s %12s %9d %9d %9d %7d %10.1f   %s\n", car.place + 1,
                 width, names[static_cast<std::size_t>(entry)].c_str(), car.grid_place + 1,
                 car.lap_times.size(), car.time,
                 (std::isfinite(car.gap) ? formatted("%+.3f", car.gap) : "-").c_str(),
                 number_text(car.best_lap(), 3).c_str(), car.overtakes, car.overtaken, car.contacts,
                 car.caused, car.distance, end_text(car).c_str());
  }
  for (const evaluation::CarContact& contact : race.contacts)
    std::fprintf(out, "contact after %.2f s: %s and %s; %s at fault\n", contact.time,
                 names[static_cast<std::size_t>(contact.cars[0])].c_str(),
                 names[static_cast<std::size_t>(contact.cars[1])].c_str(),
                 names[static_cast<std::size_t>(contact.at_fault)].c_str());
}

void print_race_line(std::FILE* out, const std::vector<std::string>& names, const GridRaceResult& race,
                     int number) {
  std::fprintf(out, "race %d:", number);
  for (const int entry : race.standings) {
    const CarResult& car = race.cars[static_cast<std::size_t>(entry)];
    const std::string time = car.place == 0 ? formatted("%.2f s", car.time) : formatted("%+.2f s", car.gap);
    std::fprintf(out, "%s %s (%s)", car.place == 0 ? "" : ",", names[static_cast<std::size_t>(entry)].c_str(),
                 (car.end == CarEnd::finished ? time : end_text(car)).c_str());
  }
  std::fprintf(out, "; contacts: %zu, overtakes: %zu%s\n", race.contacts.size(), race.overtakes.size(),
               race.cancelled ? ", interrupted" : "");
  std::fflush(out);
}

void print_race_summary(std::FILE* out, const GridRaces& races) {
  const int width = widest(races.names);
  std::fprintf(out, "\n%-*s %24s %10s %8s %4s %7s %11s %8s %8s %6s %7s  %s\n", width, "", "wins (95 %)",
               "mean place", "finished", "wall", "timeout", "best lap, s", "overtook", "contacts", "caused",
               "km", "caused per 100 km (95 %)");
  for (std::size_t entry = 0; entry < races.names.size(); ++entry) {
    const CarSummary car = car_summary(races, static_cast<int>(entry));
    const evaluation::Interval rate = evaluation::wilson_interval(car.wins, car.races);
    const std::string wins =
        formatted("%d of %d (%.0f to %.0f %%)", car.wins, car.races, 100 * rate.low, 100 * rate.high);
    std::fprintf(out, "%-*s %24s %10s %8d %4d %7d %11s %8d %8d %6d %7.2f  %s\n", width,
                 races.names[entry].c_str(), wins.c_str(),
                 number_text(static_cast<double>(car.places) / car.races, 2).c_str(), car.finished, car.walls,
                 car.timeouts, number_text(car.best_lap, 3).c_str(), car.overtakes, car.contacts.contacts,
                 car.contacts.caused, car.contacts.kilometres, contacts_text(car.contacts).c_str());
  }
  const ContactRate all = evaluation::contact_rate(races.results);
  std::fprintf(out, "all cars: %d contacts in %.2f km, %s per 100 km\n", all.contacts, all.kilometres,
               contacts_text(all).c_str());
}

Json grid_races_json(const GridRaces& races) {
  Json json{{"races", Json::array()}, {"summary", {{"cars", Json::array()}}}};
  for (std::size_t i = 0; i < races.results.size(); ++i)
    json["races"].push_back(one_race_json(races.results[i], races.names, static_cast<int>(i) + 1));
  for (std::size_t entry = 0; entry < races.names.size(); ++entry)
    json["summary"]["cars"].push_back(
        summary_json(car_summary(races, static_cast<int>(entry)), races.names[entry]));
  json["summary"]["all"] = rate_json(evaluation::contact_rate(races.results));
  return json;
}

}  // namespace slalom::tools
