words=$1; shift
for threads in 1 2; do furrow "$@" --threads $threads --no-cache --plot $threads.svg > /dev/null || exit; done
cmp 1.svg 2.svg; grep -nE 'NaN|inf' 1.svg; test $(grep -o '<g' 1.svg | wc -l) = $(grep -o '</g>' 1.svg | wc -l) || echo open groups
sed 's/<[/]*tspan[^>]*>//g' 1.svg > words
echo "$words" | tr ';' '\n' | while read -r word; do
    case $word in
        !*) grep -qF "${word#!}" words && echo "there is ${word#!}";;
        *) grep -qF "$word" words || echo "no $word";;
    esac
done
echo no picture > a.PNG; furrow "$@" --plot a.PNG > /dev/null; od -An -tu1 -j16 -N8 a.PNG
