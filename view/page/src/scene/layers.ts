/** A layer that can be shown: its name, its title, and its description. */
export const layers = [
  ["costMap", "Cost map", "where the rear axle would mean a collision, from the scan"],
  ["path", "Course line", "the line to follow"],
  ["scan", "LiDAR", "end points of the scan"],
  ["candidates", "Candidates", "sampled control sequences, coloured by cost"],
  ["guides", "Guides", "guide particles and how the solver moved them"],
  ["nominal", "Nominal", "the sequence around which samples are weighted"],
  ["plan", "Plan", "the sequence that is sent to the car"],
  ["spread", "Spread", "two standard deviations of the plan, from the solver's covariance"],
  ["driven", "Driven line", "the path of the car"],
  ["obstacles", "Obstacles", "parked cars, boxes and poles"],
  ["opponents", "Opponents", "other cars; outlines and dots: where the planner tracks and expects them"],
  ["modes", "Caption", "which way around the next obstacle the samples and the plan take"],
  ["ghost", "Ghost", "the second controller, in a world of its own; as an outline, the best lap"],
] as const;
export type Layer = (typeof layers)[number][0];

/** The terms of the cost, one of which colours the candidates. */
export const terms = ["distance", "yaw", "collision", "total"] as const;
export type Term = (typeof terms)[number];
