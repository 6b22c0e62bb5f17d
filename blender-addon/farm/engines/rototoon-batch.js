// Rototoon's job type for Flamenco. Written by `rototoon job --for flamenco`.

const JOB_TYPE = {
    label: "Rototoon batch",
    settings: [
        { key: "manifest", type: "string", subtype: "file_path", required: true,
          description: "The file that names shots and steps" },
        { key: "output", type: "string", subtype: "dir_path", required: true,
          description: "The folder of the results" },
        { key: "shots", type: "int32", required: true, default: 1,
          description: "Number of shots in the manifest" },
        { key: "chunk_size", type: "int32", default: 4,
          description: "Shots that a worker gets at a time" },
        { key: "program", type: "string", default: "rototoon",
          description: "The command line program" },
    ]
};

function compileJob(job) {
    const settings = job.settings;
    const size = Math.max(1, settings.chunk_size);
    const page = author.Task("page", "misc");
    for (let first = 1; first <= settings.shots; first += size) {
        const last = Math.min(first + size - 1, settings.shots);
        const task = author.Task(`shots-${first}-${last}`, "misc");
        task.addCommand(author.Command("exec", {
            exe: settings.program,
            args: ["batch", settings.manifest, "-o", settings.output, "--shots", `${first}-${last}`, "--fine", "all", "--progress", "lines"],
        }));
        job.addTask(task);
        page.addDependency(task);
    }
    page.addCommand(author.Command("exec", {
        exe: settings.program,
        args: ["batch", settings.manifest, "-o", settings.output, "--summary", "--fine", "keys"],
    }));
    job.addTask(page);
}
