// Fits the curves on standard input with fit-curve and paper.js, for tests/bench_fit.py.
//
// Input: {"method": "fit-curve" | "paper", "repeats": n, "points": [[x, y], …], "closed": bool, "tolerances": [e, …]}.
// Output: for each tolerance {"cubics": [[[x, y] × 4], …], "ms": the fastest of the repeats}. NODE_PATH must contain both.
const { performance } = require("node:perf_hooks");

function fitCurve(job, tolerance) {
  const fit = require("fit-curve");
  const points = job.closed ? [...job.points, job.points[0]] : job.points;
  return () => fit(points, tolerance);
}

function paper(job, tolerance) {
  const scope = require("paper/dist/paper-core.js");
  scope.setup(new scope.Size(1, 1));
  return () => {
    const path = new scope.Path({ segments: job.points, closed: job.closed, insert: false });
    path.simplify(tolerance);
    const xy = (p) => [p.x, p.y];
    return path.curves.map((c) => [xy(c.point1), xy(c.point1.add(c.handle1)), xy(c.point2.add(c.handle2)), xy(c.point2)]);
  };
}

const job = JSON.parse(require("node:fs").readFileSync(0, "utf8"));
const results = job.tolerances.map((tolerance) => {
  const run = (job.method === "paper" ? paper : fitCurve)(job, tolerance);
  let [cubics, ms] = [null, Infinity];
  for (let k = 0; k < job.repeats; k++) {
    const start = performance.now();
    const result = run();
    ms = Math.min(ms, performance.now() - start);
    cubics = result;
  }
  return { cubics, ms };
});
console.log(JSON.stringify(results));
